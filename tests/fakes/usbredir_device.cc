// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fakes/usbredir_device.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace camloc::fakes {
namespace {

constexpr std::int64_t kMicroframeNs = 125'000;
constexpr int kMaxBacklog = 4000;  // packets: half a second of one stream
constexpr std::size_t kVideoEndpoint = 0x81, kDepthEndpoint = 0x82;

int transfer(ssize_t moved) {
  if (moved > 0) return static_cast<int>(moved);
  return moved < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

/// Index of an endpoint in usb_redir_ep_info: OUT 0-15, IN 16-31.
std::size_t slot_of(std::uint8_t address) { return (address & 0x80U) >> 3U | (address & 0x0fU); }

}  // namespace

UsbredirDevice::UsbredirDevice(KinectRig* rig, UsbDeviceId id, UniqueFd socket, bool is_plugged)
    : rig_(rig), id_(id), socket_(std::move(socket)), is_plugged_(is_plugged), parser_(usbredirparser_create()) {
  install_callbacks();
  std::array<std::uint32_t, USB_REDIR_CAPS_SIZE> caps{};
  // 32-bit bulk lengths are what QEMU's xHCI asks for; its isochronous transfers do not work, use EHCI.
  for (const int cap : {usb_redir_cap_connect_device_version, usb_redir_cap_ep_info_max_packet_size, usb_redir_cap_64bits_ids,
                        usb_redir_cap_32bits_bulk_length, usb_redir_cap_device_disconnect_ack})
    usbredirparser_caps_set_cap(caps.data(), cap);
  usbredirparser_init(parser_, "camloc fake Kinect", caps.data(), USB_REDIR_CAPS_SIZE, usbredirparser_fl_usb_host);
}

UsbredirDevice::~UsbredirDevice() { usbredirparser_destroy(parser_); }

void UsbredirDevice::install_callbacks() {
  parser_->priv = this;
  parser_->log_func = [](void*, int level, const char* text) {
    if (level <= usbredirparser_warning) std::fprintf(stderr, "fake-kinect-usbredir: %s\n", text);
  };
  parser_->read_func = [](void* self, std::uint8_t* data, int size) {
    return transfer(::recv(of(self).fd(), data, static_cast<std::size_t>(size), 0));
  };
  parser_->write_func = [](void* self, std::uint8_t* data, int size) {
    return transfer(::send(of(self).fd(), data, static_cast<std::size_t>(size), MSG_NOSIGNAL));
  };
  parser_->hello_func = [](void* self, usb_redir_hello_header*) { of(self).on_hello(); };
  parser_->reset_func = [](void* self) { of(self).rig_->device(of(self).id_).reset(of(self).now_ns_); };
  parser_->set_configuration_func = [](void* self, std::uint64_t id, usb_redir_set_configuration_header* header) {
    usb_redir_configuration_status_header status{usb_redir_success, header->configuration};
    of(self).send_endpoints();
    usbredirparser_send_configuration_status(of(self).parser_, id, &status);
  };
  parser_->get_configuration_func = [](void* self, std::uint64_t id) {
    usb_redir_configuration_status_header status{usb_redir_success, 1};
    usbredirparser_send_configuration_status(of(self).parser_, id, &status);
  };
  parser_->set_alt_setting_func = [](void* self, std::uint64_t id, usb_redir_set_alt_setting_header* header) {
    usb_redir_alt_setting_status_header status{usb_redir_success, header->interface, header->alt};
    of(self).send_endpoints();
    usbredirparser_send_alt_setting_status(of(self).parser_, id, &status);
  };
  parser_->get_alt_setting_func = [](void* self, std::uint64_t id, usb_redir_get_alt_setting_header* header) {
    usb_redir_alt_setting_status_header status{usb_redir_success, header->interface, 0};
    usbredirparser_send_alt_setting_status(of(self).parser_, id, &status);
  };
  parser_->start_iso_stream_func = [](void* self, std::uint64_t id, usb_redir_start_iso_stream_header* header) {
    of(self).on_iso(id, header->endpoint, true);
  };
  parser_->stop_iso_stream_func = [](void* self, std::uint64_t id, usb_redir_stop_iso_stream_header* header) {
    of(self).on_iso(id, header->endpoint, false);
  };
  parser_->cancel_data_packet_func = [](void* self, std::uint64_t id) {
    usb_redir_control_packet_header header{};
    header.status = usb_redir_cancelled;
    usbredirparser_send_control_packet(of(self).parser_, id, &header, nullptr, 0);
  };
  parser_->control_packet_func = [](void* self, std::uint64_t id, usb_redir_control_packet_header* header, std::uint8_t* data, int size) {
    of(self).on_control(id, header, data, size);
  };
  parser_->device_disconnect_ack_func = [](void*) {};
}

void UsbredirDevice::on_hello() {
  is_greeted_ = true;
  if (is_plugged_) send_connect();
}

void UsbredirDevice::send_connect() {
  const UsbDescriptors& d = rig_->device(id_).descriptors();
  usb_redir_interface_info_header interfaces{};
  interfaces.interface_count = 1;
  interfaces.interface_class[0] = interfaces.interface_subclass[0] = interfaces.interface_protocol[0] = 0xff;
  usbredirparser_send_interface_info(parser_, &interfaces);
  send_endpoints();
  usb_redir_device_connect_header connect{};
  connect.speed = usb_redir_speed_high;
  connect.vendor_id = d.vendor_id();
  connect.product_id = d.product_id();
  connect.device_version_bcd = d.release_bcd();
  usbredirparser_send_device_connect(parser_, &connect);
}

void UsbredirDevice::send_endpoints() {
  constexpr std::uint8_t kEndpointDescriptor = 5;
  usb_redir_ep_info_header info{};
  for (std::uint8_t& type : info.type) type = usb_redir_type_invalid;
  info.type[0] = info.type[16] = usb_redir_type_control;
  info.max_packet_size[0] = info.max_packet_size[16] = 64;
  const std::vector<std::uint8_t>& bytes = rig_->device(id_).descriptors().configuration;
  for (std::size_t at = 0; at + 7 <= bytes.size() && bytes[at] > 0; at += bytes[at]) {
    if (bytes[at + 1] != kEndpointDescriptor) continue;
    const std::size_t slot = slot_of(bytes[at + 2]);
    info.type[slot] = bytes[at + 3] & 3;
    info.max_packet_size[slot] = static_cast<std::uint16_t>(bytes[at + 4] | bytes[at + 5] << 8);
    info.interval[slot] = bytes[at + 6];
  }
  usbredirparser_send_ep_info(parser_, &info);
}

void UsbredirDevice::on_control(std::uint64_t id, usb_redir_control_packet_header* header, std::uint8_t* data, int size) {
  const UsbSetup setup{header->requesttype, header->request, header->value, header->index, header->length};
  const ControlReply reply = rig_->control(id_, setup, std::span(data, static_cast<std::size_t>(size)), now_ns_);
  usb_redir_control_packet_header answer = *header;
  answer.status = static_cast<std::uint8_t>(reply.is_stalled ? usb_redir_stall : usb_redir_success);
  if (setup.is_in()) answer.length = static_cast<std::uint16_t>(reply.data.size());
  if (reply.is_stalled) answer.length = 0;
  std::vector<std::uint8_t> bytes = reply.data;
  usbredirparser_send_control_packet(parser_, id, &answer, bytes.data(), static_cast<int>(bytes.size()));
  usbredirparser_free_packet_data(parser_, data);
}

void UsbredirDevice::on_iso(std::uint64_t id, std::uint8_t endpoint, bool is_on) {
  const bool is_known = id_ == UsbDeviceId::kCamera && (endpoint == kVideoEndpoint || endpoint == kDepthEndpoint);
  if (is_known) {
    const std::size_t stream = index_of(endpoint == kVideoEndpoint ? StreamId::kVideo : StreamId::kDepth);
    is_iso_on_[stream] = is_on;
    next_id_[stream] = 0;
  }
  usb_redir_iso_stream_status_header status{static_cast<std::uint8_t>(is_known ? usb_redir_success : usb_redir_inval), endpoint};
  usbredirparser_send_iso_stream_status(parser_, id, &status);
}

bool UsbredirDevice::has_output() const { return usbredirparser_has_data_to_write(parser_) > 0; }

bool UsbredirDevice::read(std::int64_t now_ns) {
  now_ns_ = now_ns;
  return usbredirparser_do_read(parser_) == 0;
}

bool UsbredirDevice::write() { return usbredirparser_do_write(parser_) == 0; }

void UsbredirDevice::advance(std::int64_t now_ns) {
  if (id_ != UsbDeviceId::kCamera || !is_plugged_) {
    bus_ns_ = now_ns;
    return;
  }
  for (; bus_ns_ + kMicroframeNs <= now_ns; bus_ns_ += kMicroframeNs) {
    for (const StreamId stream : kBothStreams) {
      const bool is_wanted = is_iso_on_[index_of(stream)] && usbredirparser_has_data_to_write(parser_) < kMaxBacklog;
      if (!is_wanted && !rig_->is_streaming(stream)) continue;
      bool is_error = false;
      rig_->next_packet(stream, bus_ns_, is_wanted, &packet_, &is_error);
      if (is_wanted) send_packet(stream, packet_, is_error);
      if (!is_wanted && is_iso_on_[index_of(stream)]) ++num_overflowed_;
    }
  }
}

void UsbredirDevice::send_packet(StreamId stream, const IsoPacket& packet, bool is_error) {
  usb_redir_iso_packet_header header{};
  header.endpoint = static_cast<std::uint8_t>(stream == StreamId::kVideo ? kVideoEndpoint : kDepthEndpoint);
  header.status = static_cast<std::uint8_t>(is_error ? usb_redir_ioerror : usb_redir_success);
  header.length = static_cast<std::uint16_t>(packet.size);
  usbredirparser_send_iso_packet(parser_, next_id_[index_of(stream)]++, &header, packet_.bytes.data(), static_cast<int>(packet.size));
}

void UsbredirDevice::plug(bool is_plugged, std::int64_t now_ns) {
  if (is_plugged == is_plugged_) return;
  is_plugged_ = is_plugged;
  is_iso_on_ = {};
  rig_->power_cycle(now_ns);
  if (!is_greeted_) return;
  if (is_plugged) {
    send_connect();
  } else {
    usbredirparser_send_device_disconnect(parser_);
  }
}

}  // namespace camloc::fakes
