// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The fake Kinect at the end of a usb-redir connection, with a guest made of the same library's other half.
#include "tests/fakes/usbredir_device.h"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <cerrno>

namespace camloc::fakes {
namespace {

/// What QEMU would be: connects, sends control requests, starts streams, keeps what comes.
class Guest {
 public:
  explicit Guest(UniqueFd socket) : socket_(std::move(socket)), parser_(usbredirparser_create()) {
    parser_->priv = this;
    parser_->log_func = [](void*, int, const char*) {};
    parser_->read_func = [](void* self, std::uint8_t* data, int size) {
      return moved(::recv(of(self).socket_.get(), data, static_cast<std::size_t>(size), MSG_DONTWAIT));
    };
    parser_->write_func = [](void* self, std::uint8_t* data, int size) {
      return moved(::send(of(self).socket_.get(), data, static_cast<std::size_t>(size), MSG_DONTWAIT | MSG_NOSIGNAL));
    };
    parser_->hello_func = [](void*, usb_redir_hello_header*) {};
    parser_->interface_info_func = [](void*, usb_redir_interface_info_header*) {};
    parser_->ep_info_func = [](void* self, usb_redir_ep_info_header* info) { of(self).endpoints = *info; };
    parser_->device_connect_func = [](void* self, usb_redir_device_connect_header* header) {
      of(self).is_connected = true;
      of(self).device = *header;
    };
    parser_->device_disconnect_func = [](void* self) { of(self).is_connected = false; };
    parser_->iso_stream_status_func = [](void* self, std::uint64_t, usb_redir_iso_stream_status_header* header) {
      of(self).stream_status = header->status;
    };
    parser_->control_packet_func = [](void* self, std::uint64_t, usb_redir_control_packet_header* header, std::uint8_t* data, int size) {
      of(self).status = header->status;
      of(self).answer.assign(data, data + size);
      usbredirparser_free_packet_data(of(self).parser_, data);
    };
    parser_->iso_packet_func = [](void* self, std::uint64_t, usb_redir_iso_packet_header* header, std::uint8_t* data, int size) {
      if (header->endpoint == 0x82) of(self).depth_packets.emplace_back(data, data + size);
      usbredirparser_free_packet_data(of(self).parser_, data);
    };
    std::array<std::uint32_t, USB_REDIR_CAPS_SIZE> caps{};
    for (const int cap : {usb_redir_cap_connect_device_version, usb_redir_cap_ep_info_max_packet_size, usb_redir_cap_64bits_ids})
      usbredirparser_caps_set_cap(caps.data(), cap);
    usbredirparser_init(parser_, "test", caps.data(), USB_REDIR_CAPS_SIZE, 0);
  }
  ~Guest() { usbredirparser_destroy(parser_); }
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;

  void control(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t length, std::vector<std::uint8_t> data = {}) {
    usb_redir_control_packet_header header{};
    header.endpoint = type & 0x80;
    header.request = request;
    header.requesttype = type;
    header.value = value;
    header.length = length;
    usbredirparser_send_control_packet(parser_, 1, &header, data.data(), static_cast<int>(data.size()));
  }
  void start_iso(std::uint8_t endpoint) {
    usb_redir_start_iso_stream_header header{endpoint, 32, 4};
    usbredirparser_send_start_iso_stream(parser_, 2, &header);
  }
  void work() {
    EXPECT_EQ(usbredirparser_do_write(parser_), 0);
    EXPECT_EQ(usbredirparser_do_read(parser_), 0);
  }

  bool is_connected = false;
  usb_redir_device_connect_header device{};
  usb_redir_ep_info_header endpoints{};
  int status = -1, stream_status = -1;
  std::vector<std::uint8_t> answer;
  std::vector<std::vector<std::uint8_t>> depth_packets;

 private:
  static Guest& of(void* self) { return *static_cast<Guest*>(self); }
  static int moved(ssize_t size) { return size > 0 ? static_cast<int>(size) : size < 0 && errno == EAGAIN ? 0 : -1; }

  UniqueFd socket_;
  usbredirparser* parser_;
};

class UsbredirTest : public ::testing::Test {
 protected:
  void SetUp() override {
    int ends[2];
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    auto rig = KinectRig::create({});
    ASSERT_TRUE(rig);
    rig_ = std::move(*rig);
    guest_ = std::make_unique<Guest>(UniqueFd(ends[0]));
    device_ = std::make_unique<UsbredirDevice>(rig_.get(), UsbDeviceId::kCamera, UniqueFd(ends[1]), true);
    run_for(10'000'000);
  }
  /// Both ends, in simulated time.
  void run_for(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns_ + duration_ns; now_ns_ < end_ns; now_ns_ += 1'000'000) {
      guest_->work();
      ASSERT_TRUE(device_->read(now_ns_));
      device_->advance(now_ns_);
      ASSERT_TRUE(device_->write());
    }
    guest_->work();
  }

  std::unique_ptr<KinectRig> rig_;
  std::unique_ptr<Guest> guest_;
  std::unique_ptr<UsbredirDevice> device_;
  std::int64_t now_ns_ = 0;
};

TEST_F(UsbredirTest, IntroducesTheCamera) {
  EXPECT_TRUE(guest_->is_connected);
  EXPECT_EQ(guest_->device.vendor_id, 0x045e);
  EXPECT_EQ(guest_->device.product_id, 0x02ae);
  for (const int slot : {17, 18}) {
    EXPECT_EQ(guest_->endpoints.type[slot], usb_redir_type_iso);
    EXPECT_EQ(guest_->endpoints.max_packet_size[slot], 0x0bc0);
  }
}

TEST_F(UsbredirTest, AnswersControlRequests) {
  guest_->control(0x80, 6, 0x0100, 18);
  run_for(2'000'000);
  EXPECT_EQ(guest_->status, usb_redir_success);
  EXPECT_EQ(guest_->answer, rig_->device(UsbDeviceId::kCamera).descriptors().device);
  guest_->control(0x80, 6, 0x0700, 18);
  run_for(2'000'000);
  EXPECT_EQ(guest_->status, usb_redir_stall);
}

TEST_F(UsbredirTest, StreamsWholeFramesUntilUnplugged) {
  guest_->start_iso(0x82);
  guest_->control(0x40, 0, 0, 12, {'G', 'M', 2, 0, 3, 0, 1, 0, 6, 0, 2, 0});
  run_for(200'000'000);
  EXPECT_EQ(guest_->stream_status, usb_redir_success);
  std::vector<std::uint8_t> frame;
  int num_frames = 0;
  PatternShow pattern;
  for (const auto& packet : guest_->depth_packets) {
    if (packet.empty()) continue;
    if (packet[3] == 0x71) frame.clear();
    frame.insert(frame.end(), packet.begin() + kPacketHeaderBytes, packet.end());
    if (packet[3] != 0x75) continue;
    const auto expected = pattern.frame(FrameFormat::kDepth11, static_cast<std::uint64_t>(num_frames++));
    EXPECT_TRUE(std::equal(frame.begin(), frame.end(), expected.begin(), expected.end()));
  }
  EXPECT_GE(num_frames, 4);

  device_->plug(false, now_ns_);
  run_for(5'000'000);
  EXPECT_FALSE(guest_->is_connected);
  device_->plug(true, now_ns_);
  run_for(5'000'000);
  EXPECT_TRUE(guest_->is_connected);
}

}  // namespace
}  // namespace camloc::fakes
