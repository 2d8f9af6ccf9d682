// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "bindings.hpp"
#include "render_again.hpp"

namespace gatefly::python {
namespace {

struct Race {};
struct Pictures {};

}  // namespace

tasks::RenderAgain render_again() { return {}; }

void bind_race(py::module_& m) {
  py::class_<Pictures>(m, "Pictures", "The pictures of a race: this gatefly has none.");
  py::class_<Race>(m, "Race", "A race in the simulator: this gatefly was built without it.")
      .def(py::init([](const py::args&, const py::kwargs&) -> Race {
        throw std::runtime_error("gatefly.Race: this gatefly was built without the simulator");
      }));
}

}  // namespace gatefly::python
