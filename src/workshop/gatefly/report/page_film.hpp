// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "gatefly/report/onboard_film.hpp"

namespace gatefly::report {

/// The onboard film of a page. A page without it is better than no flight: what fails is
/// remembered, not thrown.
class PageFilm {
 public:
  /// @param path  where it may grow; "": no film.
  explicit PageFilm(std::filesystem::path path) : path_{std::move(path)} {}

  [[nodiscard]] bool wanted() const { return !path_.empty(); }

  /// @param expected  how many pictures there will be, about.
  /// @return its number in the film; nullopt when the film has failed.
  std::optional<std::size_t> add(const Image& picture, double expected);

  /// Once, after the last picture. @return the whole film; "" when there is none.
  [[nodiscard]] std::string finish();

  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::size_t pictures() const { return pictures_; }

 private:
  std::filesystem::path path_;
  std::optional<OnboardFilm> film_;
  std::size_t pictures_ = 0;
  bool failed_ = false;
};

}  // namespace gatefly::report
