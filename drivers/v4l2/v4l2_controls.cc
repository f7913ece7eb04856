// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Listed through VIDIOC_QUERY_EXT_CTRL, set through VIDIOC_S_EXT_CTRLS, with the older calls for drivers that lack them.
#include "drivers/v4l2/v4l2_controls.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <optional>
#include <vector>

#include "core/io/text.h"

namespace camloc {

namespace {

constexpr int kMaxControls = 256;
constexpr std::int64_t kMaxMenuEntries = 128;

struct V4l2Control {
  std::uint32_t id = 0;
  std::uint32_t type = 0;   ///< V4L2_CTRL_TYPE_*
  std::uint32_t flags = 0;  ///< V4L2_CTRL_FLAG_*
  std::string name;         ///< as control_name() makes it
  std::int64_t minimum = 0, maximum = 0;
};

bool is_settable_type(std::uint32_t type) {
  return type == V4L2_CTRL_TYPE_INTEGER || type == V4L2_CTRL_TYPE_BOOLEAN || type == V4L2_CTRL_TYPE_MENU ||
         type == V4L2_CTRL_TYPE_INTEGER_MENU || type == V4L2_CTRL_TYPE_INTEGER64 || type == V4L2_CTRL_TYPE_BITMASK ||
         type == V4L2_CTRL_TYPE_BUTTON;
}

bool is_menu(const V4l2Control& control) { return control.type == V4L2_CTRL_TYPE_MENU || control.type == V4L2_CTRL_TYPE_INTEGER_MENU; }
bool is_switch(const V4l2Control& control) { return is_menu(control) || control.type == V4L2_CTRL_TYPE_BOOLEAN; }

template <typename T, std::size_t N>
std::string name_of(const T (&field)[N]) {
  std::size_t length = 0;
  while (length < N && field[length] != 0) ++length;
  return control_name({reinterpret_cast<const char*>(&field[0]), length});
}

// Every answer names the control that comes after the one asked about. The ids must grow, or a driver could go in circles.
template <typename Query>
std::vector<V4l2Control> list_controls(const V4l2Device& device, unsigned long request) {
  std::vector<V4l2Control> controls;
  std::uint32_t id = 0;
  for (int i = 0; i < kMaxControls; ++i) {
    Query query{};
    query.id = id | V4L2_CTRL_FLAG_NEXT_CTRL;
    if (device.ioctl(request, &query) != 0 || query.id <= id) break;
    id = query.id;
    if (is_settable_type(query.type) && (query.flags & V4L2_CTRL_FLAG_DISABLED) == 0)
      controls.push_back({query.id, query.type, query.flags, name_of(query.name), query.minimum, query.maximum});
  }
  return controls;
}

std::string names_line(const std::vector<V4l2Control>& controls) {
  std::string line;
  for (const V4l2Control& control : controls) {
    if ((control.flags & V4L2_CTRL_FLAG_READ_ONLY) == 0) line += (line.empty() ? "" : ", ") + control.name;
  }
  return line.empty() ? "none" : line;
}

std::optional<std::int64_t> menu_entry(const V4l2Device& device, const V4l2Control& control, const std::string& wanted) {
  for (std::int64_t i = std::max<std::int64_t>(control.minimum, 0); i <= control.maximum && i < kMaxMenuEntries; ++i) {
    v4l2_querymenu entry{};
    entry.id = control.id;
    entry.index = static_cast<std::uint32_t>(i);
    if (control.type != V4L2_CTRL_TYPE_MENU || device.ioctl(VIDIOC_QUERYMENU, &entry) != 0) continue;  // menus have gaps
    __u8 name[sizeof(entry.name)];                                                                     // the structure is packed
    std::copy_n(entry.name, sizeof(name), name);
    if (name_of(name) == control_name(wanted)) return i;
  }
  return std::nullopt;
}

std::optional<std::int64_t> value_of(const V4l2Device& device, const V4l2Control& control, const std::string& text) {
  if (const std::optional<std::int64_t> number = parse_int(text)) return number;
  if (control.type == V4L2_CTRL_TYPE_BOOLEAN) {
    if (text == "on" || text == "true") return 1;
    if (text == "off" || text == "false") return 0;
  }
  return is_menu(control) ? menu_entry(device, control, text) : std::nullopt;
}

Status value_error(const V4l2Device& device, const V4l2Control& control, const std::string& text) {
  return {ErrorCode::kInvalid, device.path() + ": control " + control.name + "=" + text + ": expected a whole number from " +
                                   std::to_string(control.minimum) + " to " + std::to_string(control.maximum) +
                                   (control.type == V4L2_CTRL_TYPE_MENU ? " or the name of an entry" : "")};
}

int write_value(const V4l2Device& device, const V4l2Control& control, std::int64_t value) {
  v4l2_ext_control entry{};
  entry.id = control.id;
  if (control.type == V4L2_CTRL_TYPE_INTEGER64) {
    entry.value64 = value;
  } else {
    entry.value = static_cast<std::int32_t>(value);
  }
  v4l2_ext_controls all{};
  all.which = V4L2_CTRL_WHICH_CUR_VAL;
  all.count = 1;
  all.controls = &entry;
  const int error = device.ioctl(VIDIOC_S_EXT_CTRLS, &all);
  if (error != -ENOTTY || control.type == V4L2_CTRL_TYPE_INTEGER64) return error;
  v4l2_control plain{control.id, static_cast<std::int32_t>(value)};
  return device.ioctl(VIDIOC_S_CTRL, &plain);
}

/// The limits of bit masks are those of an unsigned number, and buttons have none.
bool is_in_range(const V4l2Control& control, std::int64_t value) {
  if (control.type == V4L2_CTRL_TYPE_BITMASK || control.type == V4L2_CTRL_TYPE_BUTTON) return value >= 0 && value <= 0xFFFFFFFF;
  return value >= control.minimum && value <= control.maximum;
}

Status set_control(const V4l2Device& device, const V4l2Control& control, const std::string& text) {
  if ((control.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0) {
    return {ErrorCode::kInvalid, device.path() + ": control " + control.name + " can only be read"};
  }
  const std::optional<std::int64_t> value = value_of(device, control, text);
  if (!value || !is_in_range(control, *value)) return value_error(device, control, text);
  const int error = write_value(device, control, *value);
  if (error == 0) return Status::ok();
  const ErrorCode code = error == -ENODEV ? ErrorCode::kUnavailable : ErrorCode::kInvalid;
  return {code, device.path() + ": control " + control.name + "=" + text + ": the device refuses (" + errno_text(error) + ")"};
}

}  // namespace

std::string control_name(std::string_view name) {
  std::string result;
  bool is_between = false;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 128 || std::isalnum(byte) == 0) {
      is_between = true;
      continue;
    }
    if (is_between && !result.empty()) result += '_';
    is_between = false;
    result += static_cast<char>(std::tolower(byte));
  }
  return result;
}

Status set_v4l2_controls(const V4l2Device& device, const std::map<std::string, std::string>& wanted) {
  if (wanted.empty()) return Status::ok();
  std::vector<V4l2Control> controls = list_controls<v4l2_query_ext_ctrl>(device, VIDIOC_QUERY_EXT_CTRL);
  if (controls.empty()) controls = list_controls<v4l2_queryctrl>(device, VIDIOC_QUERYCTRL);
  const auto find = [&](const std::string& name) {
    return std::find_if(controls.begin(), controls.end(), [&](const V4l2Control& control) { return control.name == control_name(name); });
  };
  for (const auto& [name, value] : wanted) {
    if (find(name) != controls.end()) continue;
    return {ErrorCode::kInvalid,
            device.path() + ": no control " + in_quotes(name) + "; '" + device.card() + "' has " + names_line(controls)};
  }
  for (const bool switches : {true, false}) {
    for (const auto& [name, value] : wanted) {
      if (is_switch(*find(name)) != switches) continue;
      if (Status status = set_control(device, *find(name), value); !status) return status;
    }
  }
  return Status::ok();
}

}  // namespace camloc
