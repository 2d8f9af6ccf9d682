// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "gatefly/files/output.hpp"
#include "gatefly/files/partial_folder.hpp"

namespace gatefly::cli {

/// A folder that is given a file or two for each picture; they are drawn aside, until all are.
class Drawings {
 public:
  /// @param flag   that names it.
  /// @param files  that the command writes elsewhere.
  /// @throws std::runtime_error one line: it cannot be written to.
  Drawings(const char* flag, std::filesystem::path folder, std::span<const files::Output> files,
           bool force)
      : folder_{std::move(folder)}, force_{force} {
    files::check_output_folder(flag, folder_, files);
    aside_ = std::make_unique<files::PartialFolder>(
        folder_, files::PartialFolder::Grows::kInside,
        [](const std::string& name) { return name.ends_with(".png") || name.ends_with(".json"); });
  }
  /// @throws CannotWrite where a file of this name is of another kind.
  void check(const std::string& name, const files::OutputKind& kind) const {
    const std::filesystem::path path = folder_ / name;
    if (!force_ && std::filesystem::exists(path) && !files::is_of_kind(path, kind))
      throw files::CannotWrite(path, "is there and is no " + std::string{kind.name} +
                                         "; choose another folder (--force replaces it)");
  }
  void write(const std::string& name, const files::OutputKind& kind,
             const std::string& content) const {
    check(name, kind);
    aside_->write(name, content);
  }
  /// Into the folder, all at once.
  void pour() { aside_->pour(); }

 private:
  std::filesystem::path folder_;
  bool force_;
  std::unique_ptr<files::PartialFolder> aside_;
};

}  // namespace gatefly::cli
