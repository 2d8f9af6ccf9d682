// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/server/http_request.hpp"

#include <algorithm>
#include <charconv>

namespace gatefly::server {
namespace {

/// Takes the part before a separator off `text`; all of it when there is no separator.
std::string_view cut(std::string_view& text, std::string_view separator) {
  const auto at = text.find(separator);
  const std::string_view before = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + separator.size());
  return before;
}

std::string lower(std::string_view text) {
  std::string result{text};
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           std::string_view{"!#$%&'*+-.^_`|~"}.find(c) != std::string_view::npos;
  });
}

/// All of the text, decimal digits only.
std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<int> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

/// "%20" is a space; nullopt where "%" is followed by something else, or stands for a zero byte.
std::optional<std::string> decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const auto high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
    if (!high || !low || (*high == 0 && *low == 0)) return std::nullopt;
    result += static_cast<char>(16 * *high + *low);
    i += 2;
  }
  return result;
}

bool is_ours(std::string_view host) {
  const std::string_view name = cut(host, ":");
  const bool port = host.empty() || (host.size() <= 5 && whole_number(host));
  return port && (name == "127.0.0.1" || lower(name) == "localhost");
}

/// One range; several, or what is no range, are as if nothing were said (RFC 9110, 14.2).
std::optional<ByteRange> range_of(std::string_view value) {
  if (cut(value, "=") != "bytes") return std::nullopt;
  const auto dash = value.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const ByteRange range{whole_number(trimmed(value.substr(0, dash))),
                        whole_number(trimmed(value.substr(dash + 1)))};
  const bool open = trimmed(value.substr(dash + 1)).empty();
  if (!range.first && dash > 0) return std::nullopt;
  if (!range.last && (!open || !range.first)) return std::nullopt;
  if (range.first && range.last && *range.first > *range.last) return std::nullopt;
  return range;
}

std::optional<Refusal> read_first_line(std::string_view line, Request& request,
                                       bool& host_is_needed) {
  const std::string_view method = cut(line, " "), target = cut(line, " ");
  if (!is_token(method) || (line != "HTTP/1.1" && line != "HTTP/1.0"))
    return Refusal{400, "no request of HTTP/1.1"};
  host_is_needed = line == "HTTP/1.1";
  if (method != "GET" && method != "HEAD") return Refusal{405, "only GET and HEAD"};
  if (target.empty() || target.front() != '/' ||
      std::any_of(target.begin(), target.end(),
                  [](unsigned char c) { return c <= ' ' || c == 0x7f; }))
    return Refusal{400, "no path"};
  request.head_only = method == "HEAD";
  request.target = target.substr(0, target.find_first_of("?#"));
  auto path = decoded(request.target);
  if (!path) return Refusal{400, "no path"};
  request.path = *std::move(path);
  return std::nullopt;
}

}  // namespace

std::variant<Request, Refusal> parsed_request(std::string_view head) {
  Request request;
  bool host_is_needed = true;
  if (const auto refusal = read_first_line(cut(head, "\r\n"), request, host_is_needed))
    return *refusal;
  std::optional<std::string_view> host;
  while (!head.empty()) {
    std::string_view value = cut(head, "\r\n");
    if (value.find_first_of(std::string_view{"\r\n\0", 3}) != std::string_view::npos ||
        value.find(':') == std::string_view::npos)
      return Refusal{400, "no header"};
    const std::string_view field = cut(value, ":");
    if (!is_token(field)) return Refusal{400, "no header"};
    const std::string name = lower(field);
    value = trimmed(value);
    if (name == "host") {
      if (host) return Refusal{400, "two hosts"};
      host = value;
    }
    if (name == "transfer-encoding" || (name == "content-length" && value != "0"))
      return Refusal{413, "a request has no body here"};
    if (name == "range") request.range = range_of(value);
  }
  if (!host && host_is_needed) return Refusal{400, "no host"};
  if (host && !is_ours(*host)) return Refusal{403, "ask for 127.0.0.1"};
  return request;
}

}  // namespace gatefly::server
