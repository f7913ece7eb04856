// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace camloc {

namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::int64_t kMaxSeconds = 9'000'000'000;  // below 2^63 nanoseconds

std::string_view without_plus(std::string_view text) {
  return text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+' ? text.substr(1) : text;
}

template <typename T>
std::optional<T> parse_number(std::string_view text) {
  text = without_plus(text);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

struct CodePoint {
  std::uint32_t value = 0;  // 0: no UTF-8
  std::size_t num_bytes = 1;
};

/// Overlong forms and surrogates are no UTF-8. `text` is not empty.
CodePoint first_code_point(std::span<const char> text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t num_bytes = lead >= 0xc2 && lead < 0xe0 ? 2 : (lead & 0xf0U) == 0xe0 ? 3 : lead >= 0xf0 && lead < 0xf5 ? 4 : 1;
  if (num_bytes == 1 || text.size() < num_bytes) return {};
  std::uint32_t value = lead & (0x7fU >> num_bytes);
  for (std::size_t i = 1; i < num_bytes; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {};
    value = value << 6U | (byte(i) & 0x3fU);
  }
  constexpr std::array<std::uint32_t, 5> kSmallest = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_fine = value >= kSmallest[num_bytes] && value <= 0x10ffff && (value < 0xd800 || value > 0xdfff);
  return is_fine ? CodePoint{value, num_bytes} : CodePoint{};
}

bool is_harmless(std::uint32_t c) {
  const auto is_in = [c](std::uint32_t first, std::uint32_t last) { return c >= first && c <= last; };
  if (c < 0xa0) return is_in(' ', '~');
  return !is_in(0x200b, 0x200f) && !is_in(0x2028, 0x202e) && !is_in(0x2060, 0x206f) && c != 0x061c && c != 0xfeff;
}

bool is_digits(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<TextLine> content_lines(std::string_view text) {
  std::vector<TextLine> lines;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    ++number;
    if (!line.empty() && line[0] != '#') lines.push_back({line, number});
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return lines;
}

std::vector<std::string_view> split_fields(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos) return fields;
    text.remove_prefix(begin);
    const std::size_t end = text.find_first_of(separators);
    fields.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end);
  }
}

std::optional<double> parse_double(std::string_view text) { return parse_number<double>(text); }

std::optional<std::int64_t> parse_int(std::string_view text) { return parse_number<std::int64_t>(text); }

std::optional<std::int64_t> parse_seconds_ns(std::string_view text) {
  text = without_plus(text);
  if (text.find_first_of("eE") != std::string_view::npos) {  // as numpy.savetxt writes by default
    const std::optional<double> seconds = parse_double(text);
    if (!seconds || !(std::abs(*seconds) <= static_cast<double>(kMaxSeconds))) return std::nullopt;
    return std::llround(*seconds * static_cast<double>(kNsPerSecond));
  }
  const bool is_negative = text.starts_with('-');
  if (is_negative) text.remove_prefix(1);
  const std::size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  std::string_view fraction = point == std::string_view::npos ? std::string_view{} : text.substr(point + 1);
  if ((whole.empty() && fraction.empty()) || !is_digits(whole) || !is_digits(fraction)) return std::nullopt;
  const std::optional<std::int64_t> seconds = whole.empty() ? 0 : parse_int(whole);
  if (!seconds || *seconds > kMaxSeconds) return std::nullopt;
  std::int64_t ns = *seconds * kNsPerSecond;
  std::int64_t unit = kNsPerSecond / 10;
  for (const char digit : fraction.substr(0, 9)) {
    ns += (digit - '0') * unit;
    unit /= 10;
  }
  return is_negative ? -ns : ns;
}

Status read_stamped_rows(std::string_view text, const std::string& path, const std::string& columns, const char* value, double largest,
                         const StampedRowReader& on_row) {
  const std::size_t num_columns = split_fields(columns).size();
  std::optional<std::int64_t> last_ns;
  std::vector<double> values;
  for (const auto& [line, number] : content_lines(text)) {
    const std::vector<std::string_view> fields = split_fields(line);
    if (fields.size() != num_columns)
      return line_error(path, number, std::to_string(fields.size()) + " fields, expected '" + columns + "'");
    const std::optional<std::int64_t> stamp_ns = parse_seconds_ns(fields[0]);
    if (!stamp_ns) return line_error(path, number, "stamp " + in_quotes(fields[0]) + " is not a time in seconds");
    values.clear();
    for (const std::string_view field : std::span(fields).subspan(1)) {
      values.push_back(parse_double(field).value_or(std::nan("")));
      if (!(std::abs(values.back()) <= largest)) return line_error(path, number, in_quotes(field) + " is not " + value);
    }
    if (const Status status = on_row(*stamp_ns, values); !status) return line_error(path, number, status.message());
    if (last_ns && *stamp_ns < *last_ns) return line_error(path, number, "stamp is before the one above it; sort the file by time");
    last_ns = stamp_ns;
  }
  return Status::ok();
}

Status line_error(const std::string& path, int line, const std::string& what) {
  return {ErrorCode::kInvalid, path + ":" + std::to_string(line) + ": " + what};
}

std::string in_double_quotes(std::string_view text, bool is_ascii) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || (is_ascii && byte > 0x7f)) {
      std::array<char, 8> code{};
      std::snprintf(code.data(), code.size(), "\\u%04x", byte);
      result += code.data();
    } else {
      if (c == '"' || c == '\\') result += '\\';
      result += c;
    }
  }
  return result + "\"";
}

void make_printable(std::span<char> text) {
  for (std::size_t i = 0; i < text.size();) {
    const CodePoint point = first_code_point(text.subspan(i));
    if (!is_harmless(point.value)) std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(i), point.num_bytes, '?');
    i += point.num_bytes;
  }
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMaxLength = 40;
  const std::string shown = printable(std::string(text.substr(0, kMaxLength)));
  return "'" + shown + (text.size() > kMaxLength ? "...'" : "'");
}

}  // namespace camloc
