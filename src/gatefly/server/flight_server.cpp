// SPDX-License-Identifier: Apache-2.0
#include "gatefly/server/flight_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <httplib.h>

#include "gatefly/pages/campaign_page.hpp"

namespace gatefly::server {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLoopback = "127.0.0.1";
constexpr int kThreads = 8;
constexpr int kPatience = 2;              // for a request that does not come, or is not read [s]
constexpr std::size_t kPiece = 64 << 10;  // of a file that is sent [bytes]

const char* type_of(const fs::path& path) {
  constexpr std::array<std::pair<const char*, const char*>, 12> kTypes{
      {{".html", "text/html; charset=utf-8"},
       {".json", "application/json"},
       {".csv", "text/plain; charset=utf-8"},
       {".toml", "text/plain; charset=utf-8"},
       {".txt", "text/plain; charset=utf-8"},
       {".png", "image/png"},
       {".jpg", "image/jpeg"},
       {".webp", "image/webp"},
       {".svg", "image/svg+xml"},
       {".mp4", "video/mp4"},
       {".webm", "video/webm"},
       {".gz", "application/gzip"}}};
  const std::string ending = path.extension().string();
  const auto* found = std::find_if(kTypes.begin(), kTypes.end(),
                                   [&](const auto& type) { return ending == type.first; });
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

void refuse(httplib::Response& response, int status, const char* why) {
  response.status = status;
  response.set_content(std::string{why} + "\n", "text/plain; charset=utf-8");
}

/// Piece by piece: a file of a flight may be larger than memory should be.
void send_file(const fs::path& path, httplib::Response& response) {
  std::error_code error;
  const auto size = static_cast<std::size_t>(fs::file_size(path, error));
  auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (error || !*file) return refuse(response, 404, "not readable");
  if (size == 0) return response.set_content("", type_of(path));
  response.set_content_provider(
      size, type_of(path), [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::vector<char> piece(std::min(length, kPiece));
        file->clear();
        file->seekg(static_cast<std::streamoff>(offset));
        file->read(piece.data(), static_cast<std::streamsize>(piece.size()));
        return file->gcount() > 0 &&
               sink.write(piece.data(), static_cast<std::size_t>(file->gcount()));
      });
}

/// A page in another site's name must not read flights (DNS rebinding).
bool is_ours(const std::string& host) {
  const std::string name = host.substr(0, host.rfind(':'));
  return name == kLoopback || name == "localhost";
}

void send_page(const fs::path& folder, httplib::Response& response) {
  switch (io::viewable(folder)) {
    case io::Viewable::kFlight:
      return send_file(folder / "report.html", response);
    case io::Viewable::kCampaign:
      return response.set_content(io::campaign_page(folder), "text/html; charset=utf-8");
    case io::Viewable::kFolder:
      return response.set_content(io::folder_page(folder), "text/html; charset=utf-8");
  }
}

void answer(const fs::path& root, const httplib::Request& request, httplib::Response& response) {
  const auto path = served(root, request.path);
  if (!path) return refuse(response, 404, "not found");
  std::error_code error;
  if (!fs::is_directory(*path, error)) return send_file(*path, response);
  if (request.path.back() != '/') {  // else the page's links would be one folder off
    return response.set_redirect(request.target.substr(0, request.target.find('?')) + "/", 301);
  }
  try {
    send_page(*path, response);
  } catch (const std::runtime_error& why) {
    refuse(response, 404, why.what());
  }
}

}  // namespace

std::optional<fs::path> served(const fs::path& root, std::string_view path) {
  // "//host" would be a redirection to elsewhere.
  if (path.empty() || path.front() != '/' || path.starts_with("//") ||
      path.find('\0') != std::string_view::npos)
    return std::nullopt;
  const fs::path wanted = fs::path{path}.relative_path();
  for (const fs::path& part : wanted)
    if (part.native().starts_with('.')) return std::nullopt;  // "..", and what is hidden
  std::error_code error;
  const fs::path there = fs::canonical(root / wanted, error);
  if (error ||
      std::mismatch(root.begin(), root.end(), there.begin(), there.end()).first != root.end())
    return std::nullopt;
  const auto status = fs::status(there, error);
  if (!fs::is_regular_file(status) && !fs::is_directory(status)) return std::nullopt;
  return there;
}

struct FlightServer::Parts {
  fs::path root;
  httplib::Server http;
  std::thread thread;
};

FlightServer::FlightServer(const fs::path& folder) : parts_{std::make_unique<Parts>()} {
  parts_->root = fs::canonical(folder);
  httplib::Server& http = parts_->http;
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_read_timeout(kPatience);
  http.set_write_timeout(kPatience);
  http.set_keep_alive_timeout(kPatience);
  http.set_payload_max_length(0);
  // Not SO_REUSEPORT, the library's own: two would share a port.
  http.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  http.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                            {"Cross-Origin-Resource-Policy", "same-origin"},
                            {"Referrer-Policy", "no-referrer"},
                            {"Cache-Control", "no-store"}});
  http.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
    using Handled = httplib::Server::HandlerResponse;
    if (request.method != "GET" && request.method != "HEAD") {
      response.set_header("Allow", "GET, HEAD");
      refuse(response, 405, "only GET and HEAD");
      return Handled::Handled;
    }
    if (!is_ours(request.get_header_value("Host"))) {
      refuse(response, 403, "ask for 127.0.0.1");
      return Handled::Handled;
    }
    return Handled::Unhandled;
  });
  http.set_exception_handler([](const httplib::Request&, httplib::Response& response, const auto&) {
    refuse(response, 500, "an error");
  });
  http.Get(".*",
           [root = parts_->root](const httplib::Request& request, httplib::Response& response) {
             answer(root, request, response);
           });
}

FlightServer::~FlightServer() {
  parts_->http.stop();
  if (parts_->thread.joinable()) parts_->thread.join();
}

int FlightServer::start(int port) {
  httplib::Server& http = parts_->http;
  if (port == 0)
    port = http.bind_to_any_port(kLoopback);
  else if (!http.bind_to_port(kLoopback, port))
    port = -1;
  if (port < 0)
    throw std::runtime_error(std::string{kLoopback} +
                             ": this port cannot be had: " + std::strerror(errno));
  parts_->thread = std::thread{[&http] { http.listen_after_bind(); }};
  while (!http.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  return port;
}

}  // namespace gatefly::server
