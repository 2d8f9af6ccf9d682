// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

#include "gatefly/files/subprocess.hpp"
#include "gatefly/report/campaign_page.hpp"
#include "gatefly/report/server/flight_server.hpp"

#include "commands.hpp"

namespace gatefly::cli {
namespace {

struct ViewOptions {
  std::string path;
  int port = 0;
  bool open = false, quiet = false;
};

const char* name_of(report::Viewable what) {
  switch (what) {
    case report::Viewable::kFlight:
      return "a flight";
    case report::Viewable::kCampaign:
      return "a campaign";
    case report::Viewable::kFolder:
      break;
  }
  return "a folder of flights";
}

/// Nobody waits for it: it may run as long as the browser does.
void open_browser(const std::string& url) {
  pid_t pid = -1;
  const int error = files::start({"xdg-open", url}, {}, pid);
  if (error != 0)
    std::cerr << "gatefly view: xdg-open: " << std::system_category().message(error)
              << "; open the address yourself\n";
}

/// gatefly view: shows until Ctrl-C.
int view(const ViewOptions& options) {
  const report::Viewable what = report::viewable(options.path);
  server::FlightServer server{options.path};
  catch_interrupt();
  const std::string url = "http://127.0.0.1:" + std::to_string(server.start(options.port)) + "/";
  std::cout << url << std::endl;  // at once, for who reads it from a pipe
  if (!options.quiet)
    std::cerr << "gatefly view: " << options.path << ", " << name_of(what)
              << ", to browsers of this machine only; Ctrl-C ends it\n";
  if (options.open) open_browser(url);
  while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds{50});
  // There is nothing to lose, and a page that is being made is not waited for.
  std::_Exit(128 + interrupting_signal());
}

}  // namespace

void declare_view(Command& command) {
  auto options = std::make_shared<ViewOptions>();
  command.footer(
      "Example:\n  gatefly view out/showroom-1\n  gatefly view out --open\n\n"
      "Prints the address. Nothing is changed, nothing is sent anywhere, other machines get no "
      "answer.\n"
      "Exit code 2: no flight, no campaign, or the port is taken; 130: Ctrl-C, its only other "
      "end.");
  command.option("PATH", options->path, "a flight's folder, a folder of flights, or a campaign's")
      .required()
      .path();
  command.option("--port", options->port, "of 127.0.0.1 [any that is free]").between(1, 65535);
  command.flag("--open", options->open, "open it in the browser, too (xdg-open)");
  command.flag("-q,--quiet", options->quiet, "print the address only");
  command.runs([options] { return view(*options); });
}

}  // namespace gatefly::cli
