// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/server/http_request.hpp"

#include <random>
#include <string>

#include <gtest/gtest.h>

namespace gatefly::server {
namespace {

std::string get(const std::string& target, const std::string& more = "") {
  return "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:8080" + more;
}

/// 0: it is taken.
int status_of(const std::string& head) {
  const auto parsed = parsed_request(head);
  const auto* refusal = std::get_if<Refusal>(&parsed);
  return refusal == nullptr ? 0 : refusal->status;
}

Request request_of(const std::string& head) {
  const auto parsed = parsed_request(head);
  const auto* request = std::get_if<Request>(&parsed);
  EXPECT_NE(request, nullptr) << head;
  return request == nullptr ? Request{} : *request;
}

TEST(HttpRequest, SaysWhatIsWanted) {
  const Request request = request_of(get("/a%20flight/report.html?x=/../y"));
  EXPECT_FALSE(request.head_only);
  EXPECT_EQ(request.path, "/a flight/report.html");
  EXPECT_EQ(request.target, "/a%20flight/report.html");
  EXPECT_FALSE(request.range);
  EXPECT_TRUE(request_of("HEAD / HTTP/1.1\r\nhost:\tLOCALHOST \r\nX: y").head_only);
  EXPECT_EQ(request_of("GET / HTTP/1.0").path, "/");  // before hosts had names
}

TEST(HttpRequest, AnotherMethodAnotherHostOrABodyIsRefused) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "get"})
    EXPECT_EQ(status_of(std::string{method} + " / HTTP/1.1\r\nHost: localhost"), 405) << method;
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "127.0.0.2", "", "[::1]",
                           "127.0.0.1:80:80", "127.0.0.1:x", "127.0.0.1:999999", "a@127.0.0.1"})
    EXPECT_EQ(status_of(std::string{"GET / HTTP/1.1\r\nHost: "} + host), 403) << host;
  EXPECT_EQ(status_of("GET / HTTP/1.1"), 400);
  EXPECT_EQ(status_of(get("/", "\r\nHost: 127.0.0.1")), 400);
  EXPECT_EQ(status_of(get("/", "\r\nContent-Length: 5")), 413);
  EXPECT_EQ(status_of(get("/", "\r\nContent-Length: 0")), 0);
  EXPECT_EQ(status_of(get("/", "\r\nTransfer-Encoding: chunked")), 413);
}

TEST(HttpRequest, WhatIsNoRequestIsRefused) {
  for (const std::string& head : {std::string{},
                                  std::string{"GET"},
                                  std::string{"GET /"},
                                  std::string{"GET / HTTP/2.0"},
                                  std::string{"GET  / HTTP/1.1"},
                                  std::string{" GET / HTTP/1.1"},
                                  get("http://127.0.0.1/"),
                                  get("*"),
                                  get("/%"),
                                  get("/%4"),
                                  get("/%zz"),
                                  get("/%00"),
                                  get("/a\x01"),
                                  get("/a\tb"),
                                  get("/", "\r\nno colon"),
                                  get("/", "\r\n: no name"),
                                  get("/", "\r\nname : spaced"),
                                  get("/", "\r\n folded: line"),
                                  get("/", "\r\nX: a\nY: b"),
                                  get("/", "\r\nX: a\rY: b"),
                                  get("/", std::string{"\r\nX: a\0b", 8})})
    EXPECT_EQ(status_of(head), 400) << head;
}

TEST(HttpRequest, OneRangeIsUnderstoodAndOthersAreAsIfNotSaid) {
  const auto range = [](const std::string& text) {
    return request_of(get("/", "\r\nRange: " + text)).range;
  };
  EXPECT_EQ(range("bytes=10-19")->first, 10u);
  EXPECT_EQ(range("bytes=10-19")->last, 19u);
  EXPECT_EQ(range("bytes=10-")->first, 10u);
  EXPECT_FALSE(range("bytes=10-")->last);
  EXPECT_FALSE(range("bytes=-5")->first);
  EXPECT_EQ(range("bytes=-5")->last, 5u);
  for (const char* text :
       {"", "bytes", "bytes=", "bytes=-", "bytes=5", "bytes=9-5", "bytes=1-2,4-5", "lines=1-2",
        "bytes=a-b", "bytes=-1-2", "bytes=99999999999999999999-"})
    EXPECT_FALSE(range(text)) << text;
}

TEST(HttpRequest, AnyBytesGetAnAnswer) {
  std::mt19937 random{1};
  const std::string whole = get("/a%20flight/", "\r\nRange: bytes=1-2\r\nAccept: */*");
  int taken = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string head = whole;
    for (int k = static_cast<int>(random() % 4); k >= 0; --k)
      head[random() % head.size()] = static_cast<char>(random());
    head.resize(random() % 3 == 0 ? random() % head.size() : head.size());
    const int status = status_of(head);
    taken += status == 0;
    EXPECT_TRUE(status == 0 || (status >= 400 && status < 500)) << head;
  }
  EXPECT_GT(taken, 0);
}

}  // namespace
}  // namespace gatefly::server
