// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The control socket against clients that are polite, slow, silent, greedy and gone.
#include "daemon/control_socket.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cstring>
#include <vector>

#include "tests/daemon/test_folder.h"

namespace camloc {
namespace {

using testing::TestFolder;

class ControlSocketTest : public ::testing::Test {
 protected:
  ControlSocketTest() : path_(folder_.file("control.sock")) {
    Result<std::unique_ptr<ControlSocket>> opened = ControlSocket::open(path_);
    EXPECT_TRUE(opened) << opened.status().message();
    socket_ = std::move(opened).value();
  }

  [[nodiscard]] UniqueFd connect() const {
    UniqueFd client(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.c_str(), path_.size());
    EXPECT_EQ(::connect(client.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0) << std::strerror(errno);
    return client;
  }
  /// One turn of a main loop.
  void turn(std::int64_t now_ns = 0) {
    std::array<pollfd, ControlSocket::kMaxPollFds> fds{};
    const int count = socket_->prepare_poll(fds);
    ::poll(fds.data(), static_cast<nfds_t>(count), 0);
    socket_->handle(std::span(fds).first(static_cast<std::size_t>(count)), now_ns, [this](const ControlRequest&) {
      ++num_handled_;
      return reply_;
    });
    socket_->expire(now_ns);
  }
  void turns(int count) {
    for (int i = 0; i < count; ++i) turn();
  }
  static void say(const UniqueFd& client, const std::string& text) {
    EXPECT_EQ(::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
  }
  /// What arrived, and "<eof>" when the connection is closed.
  static std::string hear(const UniqueFd& client) {
    std::string text;
    std::array<char, 4096> bytes{};
    ssize_t count = 0;
    while ((count = ::recv(client.get(), bytes.data(), bytes.size(), 0)) > 0) text.append(bytes.data(), static_cast<std::size_t>(count));
    return count == 0 ? text + "<eof>" : text;
  }

  TestFolder folder_;
  std::string path_;
  std::unique_ptr<ControlSocket> socket_;
  std::string reply_ = "{\"ok\":true}";
  int num_handled_ = 0;
};

TEST_F(ControlSocketTest, AnswersOneLineAndCloses) {
  const UniqueFd client = connect();
  say(client, "status\n");
  turns(2);
  EXPECT_EQ(hear(client), "{\"ok\":true}\n<eof>");
  EXPECT_EQ(num_handled_, 1);
}

TEST_F(ControlSocketTest, RequestMayComeInPieces) {
  const UniqueFd client = connect();
  for (const char* piece : {"re", "lo", "ad"}) {
    say(client, piece);
    turns(2);
    EXPECT_EQ(hear(client), "");
  }
  say(client, "\n");
  turn();
  EXPECT_EQ(hear(client), "{\"ok\":true}\n<eof>");
}

TEST_F(ControlSocketTest, RequestMayEndWithTheStream) {
  const UniqueFd client = connect();
  say(client, "status");
  ::shutdown(client.get(), SHUT_WR);
  turns(3);
  EXPECT_EQ(hear(client), "{\"ok\":true}\n<eof>");
}

TEST_F(ControlSocketTest, GarbageIsAnsweredWithAnError) {
  const UniqueFd client = connect();
  say(client, std::string("\0\xff{}\n", 5));
  turns(2);
  EXPECT_EQ(hear(client).find("{\"ok\":false,\"error\":\"unknown command"), 0U);
  EXPECT_EQ(num_handled_, 0);
}

TEST_F(ControlSocketTest, EndlessLineIsRefused) {
  const UniqueFd client = connect();
  say(client, std::string(5000, 'x'));
  turns(3);
  EXPECT_EQ(hear(client), "{\"ok\":false,\"error\":\"request too long\"}\n<eof>");
}

TEST_F(ControlSocketTest, SecondLineIsIgnored) {
  const UniqueFd client = connect();
  say(client, "status\nreload\n");
  turns(3);
  EXPECT_EQ(hear(client), "{\"ok\":true}\n<eof>");
  EXPECT_EQ(num_handled_, 1);
}

TEST_F(ControlSocketTest, SilentClientIsDroppedInTime) {
  const UniqueFd client = connect();
  turn(0);
  turn(ControlSocket::kPatience_ns);
  EXPECT_EQ(hear(client), "");
  turn(ControlSocket::kPatience_ns + 1);
  EXPECT_EQ(hear(client), "") << "it may have spoken while the daemon was busy";
  turn(ControlSocket::kPatience_ns + 2);
  EXPECT_EQ(hear(client), "<eof>");
}

TEST_F(ControlSocketTest, WhoSpokeWhileTheDaemonWasBusyIsAnswered) {
  const UniqueFd client = connect();
  turn(0);
  say(client, "reload\n");
  socket_->expire(5 * ControlSocket::kPatience_ns);  // a frame took so long
  turn(5 * ControlSocket::kPatience_ns);
  EXPECT_EQ(hear(client), "{\"ok\":true}\n<eof>");
  EXPECT_EQ(num_handled_, 1);
}

TEST_F(ControlSocketTest, ClientThatDoesNotReadHoldsNobodyUp) {
  reply_ = std::string(4 << 20, 'x');  // more than the kernel buffers
  const UniqueFd greedy = connect();
  say(greedy, "status\n");
  turns(3);
  reply_ = "short";
  const UniqueFd other = connect();
  say(other, "status\n");
  turns(3);
  EXPECT_EQ(hear(other), "short\n<eof>");
}

TEST_F(ControlSocketTest, LongReplyArrivesWhole) {
  reply_ = std::string(4 << 20, 'x');
  const UniqueFd client = connect();
  say(client, "status\n");
  std::string heard;
  for (int i = 0; i < 1000 && !heard.ends_with("<eof>"); ++i) {
    turn();
    heard += hear(client);
  }
  EXPECT_EQ(heard.size(), reply_.size() + std::strlen("\n<eof>"));
}

TEST_F(ControlSocketTest, ClientsBeyondTheLimitWait) {
  std::vector<UniqueFd> silent;
  for (int i = 0; i < ControlSocket::kMaxClients; ++i) silent.push_back(connect());
  turns(2);
  const UniqueFd late = connect();
  say(late, "status\n");
  turns(3);
  EXPECT_EQ(hear(late), "");
  silent.clear();
  turns(4);
  EXPECT_EQ(hear(late), "{\"ok\":true}\n<eof>");
}

TEST_F(ControlSocketTest, SilentClientsMakeRoomForThoseThatWait) {
  std::vector<UniqueFd> silent;
  for (int i = 0; i < ControlSocket::kMaxClients; ++i) silent.push_back(connect());
  turns(2);
  turn(ControlSocket::kCrowded_ns + 1);
  turn(ControlSocket::kCrowded_ns + 1);
  EXPECT_EQ(hear(silent.front()), "") << "nobody else wants the place";
  const UniqueFd client = connect();
  say(client, "status\n");
  for (int i = 0; i < 4; ++i) turn(ControlSocket::kCrowded_ns + 1);
  EXPECT_EQ(hear(client), reply_ + "\n<eof>");
  EXPECT_EQ(hear(silent.front()), "<eof>");
}

TEST_F(ControlSocketTest, WithoutADescriptorLeftTheLoopStillWaits) {
  const UniqueFd client = connect();
  say(client, "status\n");
  rlimit old_limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &old_limit), 0);
  rlimit limit = old_limit;
  limit.rlim_cur = 3;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
  std::array<pollfd, ControlSocket::kMaxPollFds> fds{};
  ASSERT_EQ(socket_->prepare_poll(fds), 1);
  fds[0].revents = POLLIN;
  socket_->handle(std::span(fds).first(1), 0, [](const ControlRequest&) { return std::string(); });
  EXPECT_EQ(socket_->prepare_poll(fds), 0) << "the listener is readable and cannot be served";
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &old_limit), 0);
  socket_->expire(0);
  turns(3);
  EXPECT_EQ(hear(client), reply_ + "\n<eof>");
}

TEST_F(ControlSocketTest, VanishedClientIsForgotten) {
  { const UniqueFd client = connect(); }
  turns(3);
  const UniqueFd client = connect();
  say(client, "status\n");
  {
    const UniqueFd leaver = connect();
    say(leaver, "status\n");
  }
  turns(3);
  EXPECT_EQ(hear(client), "{\"ok\":true}\n<eof>");
}

TEST_F(ControlSocketTest, ModeIsGroupOnlyAndFileGoesAway) {
  struct stat info {};
  ASSERT_EQ(::stat(path_.c_str(), &info), 0);
  EXPECT_TRUE(S_ISSOCK(info.st_mode));
  EXPECT_EQ(info.st_mode & 0777U, 0660U);
  socket_.reset();
  EXPECT_NE(::stat(path_.c_str(), &info), 0);
}

TEST_F(ControlSocketTest, SecondOwnerIsRefused) {
  const Result<std::unique_ptr<ControlSocket>> second = ControlSocket::open(path_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.status().code(), ErrorCode::kUnavailable);
  EXPECT_NE(second.status().message().find(path_), std::string::npos);
  const UniqueFd client = connect();
  say(client, "status\n");
  turns(2);
  EXPECT_EQ(hear(client), "{\"ok\":true}\n<eof>") << "the first one goes on";
}

TEST(ControlSocketFileTest, StaleSocketIsReplaced) {
  const TestFolder folder;
  const std::string path = folder.file("s");
  {
    const UniqueFd dead(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.c_str(), path.size());
    ASSERT_EQ(::bind(dead.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  ASSERT_TRUE(std::filesystem::exists(path));
  EXPECT_TRUE(ControlSocket::open(path));
}

TEST(ControlSocketFileTest, AnotherProgramsSocketIsLeftAlone) {
  const TestFolder folder;
  const std::string path = folder.file("s");
  const UniqueFd other(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path.c_str(), path.size());
  ASSERT_EQ(::bind(other.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ASSERT_EQ(::listen(other.get(), 1), 0);
  EXPECT_EQ(ControlSocket::open(path).status().code(), ErrorCode::kUnavailable);
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST(ControlSocketFileTest, WrongPathsAreErrors) {
  const TestFolder folder;
  const std::string file = folder.write("precious", "data");
  EXPECT_EQ(ControlSocket::open(file).status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(std::filesystem::file_size(file), 4U);
  EXPECT_EQ(ControlSocket::open(folder.file("none/s")).status().code(), ErrorCode::kIo);
  EXPECT_EQ(ControlSocket::open(folder.file(std::string(120, 'x'))).status().code(), ErrorCode::kInvalid);
}

}  // namespace
}  // namespace camloc
