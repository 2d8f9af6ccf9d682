// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/server/flight_server.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "gatefly/files/text.hpp"
#include "gatefly/report/campaign_page.hpp"
#include "gatefly/report/server/http_listener.hpp"

namespace gatefly::server {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHtml = "text/html; charset=utf-8";
constexpr std::uintmax_t kLargestPage = 64 << 20;  // that is changed on its way [bytes]

/// Pages are whole in themselves: scripts and styles in them run, nothing is loaded but what the page
/// holds, nothing is sent anywhere.
constexpr const char* kPage =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: "
    "blob:; "
    "media-src data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// A flight's page may be somebody else's: it cannot read the other flights, either.
constexpr const char* kStrangersPage = "; sandbox allow-scripts allow-downloads";
/// A picture or film that is opened by itself: a browser makes a page of its own around it.
constexpr const char* kPicture =
    "default-src 'none'; img-src 'self' data:; media-src 'self'; style-src 'unsafe-inline'";

const char* type_of(const fs::path& path) {
  constexpr std::array<std::pair<const char*, const char*>, 12> kTypes{
      {{".html", kHtml},
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

Answer refusal(int status, const std::string& why) {
  return {.status = status, .body = why + "\n"};
}

/// A page below the one that lists it gets the way back to that.
std::string with_way_back(std::string page, const fs::path& root, const fs::path& folder) {
  const auto body = page.find("<body");
  const auto end = body == std::string::npos ? body : page.find('>', body);
  if (folder == root || end == std::string::npos) return page;
  std::error_code error;
  const bool in_campaign = fs::exists(folder.parent_path() / "campaign.json", error);
  page.insert(end + 1,
              std::string{"\n<nav style=\"padding-top:10px;font-size:13px\"><a href=\"../\" "
                          "style=\"color:inherit\">← "} +
                  (in_campaign ? "the campaign" : "all flights") + "</a></nav>");
  return page;
}

Answer file_answer(const fs::path& root, const fs::path& path) {
  const std::string type = type_of(path);
  std::error_code error;
  if (type == kHtml && fs::file_size(path, error) <= kLargestPage && !error) {
    std::string policy = kPage;
    policy += kStrangersPage;
    return {.type = type,
            .body = with_way_back(files::read_file(path), root, path.parent_path()),
            .policy = policy};
  }
  const bool seen = type.starts_with("image/") || type.starts_with("video/");
  return {.type = type, .file = path, .policy = seen ? kPicture : ""};
}

Answer page_answer(const fs::path& root, const fs::path& folder) {
  switch (report::viewable(folder)) {
    case report::Viewable::kFlight:
      break;
    case report::Viewable::kCampaign:
      return {.type = kHtml,
              .body = with_way_back(report::campaign_page(folder), root, folder),
              .policy = kPage};
    case report::Viewable::kFolder:
      return {.type = kHtml,
              .body = with_way_back(report::folder_page(folder), root, folder),
              .policy = kPage};
  }
  return file_answer(root, folder / "report.html");
}

Answer answer(const fs::path& root, const Request& request) {
  const auto path = served(root, request.path);
  if (!path) return refusal(404, "not found");
  std::error_code error;
  try {
    if (!fs::is_directory(*path, error)) return file_answer(root, *path);
    if (request.path.back() != '/')  // else the page's links would be one folder off
      return {.status = 301, .location = request.target + "/"};
    return page_answer(root, *path);
  } catch (const std::runtime_error& why) {
    return refusal(404, why.what());
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
  HttpListener http;
};

FlightServer::FlightServer(const fs::path& folder)
    : parts_{new Parts{HttpListener{[root = fs::canonical(folder)](const Request& request) {
        return answer(root, request);
      }}}} {}

FlightServer::~FlightServer() = default;

int FlightServer::start(int port) { return parts_->http.start(port); }

}  // namespace gatefly::server
