// SPDX-License-Identifier: Apache-2.0
#include "gatefly/report/page_film.hpp"

#include <stdexcept>

namespace gatefly::report {

std::optional<std::size_t> PageFilm::add(const Image& picture, double expected) try {
  if (failed_) return std::nullopt;
  if (!film_) film_.emplace(path_, picture, expected);
  film_->add(picture);
  return pictures_++;
} catch (const std::runtime_error&) {
  failed_ = true;
  return std::nullopt;
}

std::string PageFilm::finish() {
  std::string bytes;
  if (film_ && !failed_) try {
      bytes = film_->finish();
    } catch (const std::runtime_error&) {
      failed_ = true;
    }
  film_.reset();
  return bytes;
}

}  // namespace gatefly::report
