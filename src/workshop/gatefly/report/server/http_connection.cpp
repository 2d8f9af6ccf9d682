// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/server/http_connection.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gatefly::server {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

constexpr seconds kToAsk{5};              // for a whole request, however slowly it comes
constexpr seconds kToTake{30};            // for an answer, ...
constexpr double kRate = 256e3;           // ... and for its length [bytes/s]
constexpr seconds kToLeave{1};            // for the client to hang up
constexpr std::size_t kPiece = 64 << 10;  // of a file that is sent [bytes]

/// A socket with a time when all must be over.
class Line {
 public:
  explicit Line(int socket) : socket_{socket} {}
  void until(Clock::time_point deadline) { deadline_ = deadline; }

  /// Some bytes; 0: the end, or the time is over.
  std::size_t receive(char* to, std::size_t most) {
    while (wait(POLLIN)) {
      const ssize_t count = ::recv(socket_, to, most, MSG_DONTWAIT);
      if (count >= 0) return static_cast<std::size_t>(count);
      if (errno != EINTR && errno != EAGAIN) break;
    }
    return 0;
  }

  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      if (!wait(POLLOUT)) return false;
      const ssize_t count =
          ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
      if (count < 0 && errno != EINTR && errno != EAGAIN) return false;
      if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  /// Sends what is left and takes what the client still says, or it would not hear us.
  void hang_up() {
    ::shutdown(socket_, SHUT_WR);
    until(Clock::now() + kToLeave);
    std::array<char, 4096> rest;
    while (receive(rest.data(), rest.size()) > 0) continue;
  }

 private:
  [[nodiscard]] bool wait(short event) const {
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
      if (left <= 0) return false;
      pollfd one{socket_, event, 0};
      const int ready = ::poll(&one, 1, static_cast<int>(left));
      if (ready > 0) return true;
      if (ready < 0 && errno != EINTR) return false;
    }
  }

  int socket_;
  Clock::time_point deadline_{};
};

/// Up to the empty line; nullopt when nothing at all was said.
std::optional<std::variant<Request, Refusal>> read_request(Line& line) {
  line.until(Clock::now() + kToAsk);
  std::string head(kMostHead, '\0');
  std::size_t length = 0;
  for (;;) {
    const std::size_t count = line.receive(head.data() + length, head.size() - length);
    if (count == 0 && length == 0) return std::nullopt;
    if (count == 0) return Refusal{408, "the request does not end"};
    length += count;
    const std::string_view so_far{head.data(), length};
    if (const auto end = so_far.find("\r\n\r\n"); end != std::string_view::npos)
      return parsed_request(so_far.substr(0, end));
    if (length == head.size())
      return so_far.find('\n') == std::string_view::npos ? Refusal{414, "the address is too long"}
                                                         : Refusal{431, "the head is too long"};
  }
}

const char* reason_of(int status) {
  constexpr std::array<std::pair<int, const char*>, 13> kReasons{
      {{200, "OK"},
       {206, "Partial Content"},
       {301, "Moved Permanently"},
       {400, "Bad Request"},
       {403, "Forbidden"},
       {404, "Not Found"},
       {405, "Method Not Allowed"},
       {408, "Request Timeout"},
       {413, "Content Too Large"},
       {414, "URI Too Long"},
       {416, "Range Not Satisfiable"},
       {431, "Request Header Fields Too Large"},
       {500, "Internal Server Error"}}};
  const auto* found = std::find_if(kReasons.begin(), kReasons.end(),
                                   [&](const auto& reason) { return reason.first == status; });
  return found == kReasons.end() ? "Error" : found->second;
}

std::string head_of(const Answer& answer, std::uint64_t length, const std::string& more) {
  std::string head =
      "HTTP/1.1 " + std::to_string(answer.status) + " " + reason_of(answer.status) +
      "\r\nContent-Type: " + answer.type + "\r\nContent-Length: " + std::to_string(length) +
      "\r\nConnection: close\r\nCache-Control: no-store"
      "\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer"
      "\r\nCross-Origin-Resource-Policy: same-origin\r\nContent-Security-Policy: " +
      (answer.policy.empty() ? "default-src 'none'; sandbox" : answer.policy) + "\r\n" + more;
  if (answer.status == 405) head += "Allow: GET, HEAD\r\n";
  if (!answer.location.empty()) head += "Location: " + answer.location + "\r\n";
  return head + "\r\n";
}

Answer said(int status, const char* why) {
  return {.status = status, .body = std::string{why} + "\n"};
}

/// A regular file, open.
class File {
 public:
  /// It may have become something else since it was looked at: a pipe must not keep us waiting.
  explicit File(const std::filesystem::path& path)
      : file_{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)} {
    struct stat status {};
    if (file_ >= 0 && ::fstat(file_, &status) == 0 && S_ISREG(status.st_mode))
      size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~File() {
    if (file_ >= 0) ::close(file_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  [[nodiscard]] std::optional<std::uint64_t> size() const { return size_; }
  /// Fewer bytes than asked for when it has become shorter.
  [[nodiscard]] std::string_view piece(std::uint64_t from, std::uint64_t most) {
    buffer_.resize(kPiece);
    const ssize_t count = ::pread(file_, buffer_.data(), std::min<std::uint64_t>(most, kPiece),
                                  static_cast<off_t>(from));
    return {buffer_.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }

 private:
  int file_;
  std::optional<std::uint64_t> size_;
  std::string buffer_;
};

/// From (inclusive) and to (exclusive); nullopt when no byte of the range is there.
std::optional<std::pair<std::uint64_t, std::uint64_t>> within(const ByteRange& range,
                                                              std::uint64_t size) {
  if (!range.first) {
    if (*range.last == 0 || size == 0) return std::nullopt;
    return std::pair{size - std::min(*range.last, size), size};
  }
  if (*range.first >= size) return std::nullopt;
  return std::pair{*range.first, range.last ? std::min(*range.last, size - 1) + 1 : size};
}

Clock::time_point time_for(std::uint64_t bytes) {
  return Clock::now() + kToTake +
         std::chrono::duration_cast<Clock::duration>(
             std::chrono::duration<double>(static_cast<double>(bytes) / kRate));
}

void send_text(Line& line, const Answer& answer, bool head_only, const std::string& more = "") {
  line.until(time_for(answer.body.size()));
  if (line.send(head_of(answer, answer.body.size(), more)) && !head_only) line.send(answer.body);
}

void send_file(Line& line, Answer answer, const Request& request) {
  File file{answer.file};
  const auto size = file.size();
  if (!size) return send_text(line, said(404, "not readable"), request.head_only);
  std::pair<std::uint64_t, std::uint64_t> part{0, *size};
  std::string more = "Accept-Ranges: bytes\r\n";
  if (request.range) {
    const auto asked = within(*request.range, *size);
    if (!asked)
      return send_text(line, said(416, "not so long"), request.head_only,
                       "Content-Range: bytes */" + std::to_string(*size) + "\r\n");
    part = *asked;
    answer.status = 206;
    more += "Content-Range: bytes " + std::to_string(part.first) + "-" +
            std::to_string(part.second - 1) + "/" + std::to_string(*size) + "\r\n";
  }
  line.until(time_for(part.second - part.first));
  if (!line.send(head_of(answer, part.second - part.first, more)) || request.head_only) return;
  for (std::uint64_t at = part.first; at < part.second;) {
    const std::string_view piece = file.piece(at, part.second - at);
    if (piece.empty() || !line.send(piece)) return;
    at += piece.size();
  }
}

Answer answer_of(const HttpListener::Answerer& answerer, const Request& request) try {
  return answerer(request);
} catch (const std::exception&) {
  return said(500, "an error");
}

}  // namespace

void serve(int socket, const HttpListener::Answerer& answerer, std::atomic<bool>& asking) {
  Line line{socket};
  const auto read = read_request(line);
  asking = false;
  if (!read) return line.hang_up();
  if (const auto* refusal = std::get_if<Refusal>(&*read)) {
    send_text(line, said(refusal->status, refusal->why), false);
  } else {
    const Request& request = std::get<Request>(*read);
    Answer answer = answer_of(answerer, request);
    if (answer.file.empty())
      send_text(line, answer, request.head_only);
    else
      send_file(line, std::move(answer), request);
  }
  line.hang_up();
}

}  // namespace gatefly::server
