// SPDX-License-Identifier: Apache-2.0
#include "gatefly/simulated_race/closed_loop/race.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <pybind11/stl.h>

#include "gatefly/files/text.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/simulated_race/race_maker.hpp"
#include "gatefly/simulated_race/rendered_again.hpp"

#include "arguments.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "json.hpp"
#include "picture.hpp"
#include "render_again.hpp"

namespace gatefly::python {
namespace {

/// Converts any whole number, numpy's as well.
std::uint64_t seed_of(const py::object& given) {
  const auto seed = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!seed) throw py::error_already_set();
  const std::uint64_t value = PyLong_AsUnsignedLongLong(seed.ptr());
  if (PyErr_Occurred() == nullptr) return value;
  PyErr_Clear();
  throw std::runtime_error("seed = " + files::one_line(py::str(seed)) + ", must be in 0..2^64 - 1");
}

simulated_race::Race race_of(const py::object& track, const py::object& seed,
                             const std::string& vision, std::optional<int> laps,
                             const py::object& config, const py::object& settings) {
  if (vision != "rendered" && vision != "ideal")
    throw std::runtime_error("vision = '" + files::one_line(vision) +
                             "', must be 'rendered' or 'ideal'");
  if (laps && (*laps < 1 || *laps > 100))
    throw std::runtime_error("laps = " + std::to_string(*laps) + ", must be in 1..100");
  const simulated_race::RaceMaker maker({.config = config_arguments(config, settings),
                                         .track = path_of(track, "track"),
                                         .vision = vision,
                                         .laps = laps});
  warn(maker.notes());
  return maker.race(seed_of(seed));
}

/// gatefly.Race: `gatefly fly`, tick by tick.
class Race {
 public:
  explicit Race(simulated_race::Race race) : race_{std::move(race)} {
    race_.config.while_baking = check_signals;
    const py::gil_scoped_release light_may_have_to_be_baked;
    flight_ = std::make_unique<simulated_race::Flight>(race_.config);
  }

  bool step() {
    const Alone alone{*this};
    const py::gil_scoped_release others_may_run;
    return flight_->step();
  }
  /// Until a picture has arrived; false when the race is over before.
  bool step_to_picture() {
    const Alone alone{*this};
    const py::gil_scoped_release others_may_run;
    while (flight_->step())
      if (has_picture()) return true;
    return false;
  }
  void run() {
    const Alone alone{*this};
    const py::gil_scoped_release others_may_run;
    constexpr int kAskEvery = 256;  // half a second of flight
    for (int ticks = 1; flight_->step(); ++ticks)
      if (ticks % kAskEvery == 0) check_signals();
  }
  void stop() {
    check_alone();
    if (!flight_->over()) flight_->stop();
  }

  [[nodiscard]] flight_log::Tick tick() const {
    check_alone();
    return flight_->tick();
  }
  [[nodiscard]] bool over() const {
    check_alone();
    return flight_->over();
  }
  [[nodiscard]] bool has_picture() const { return flight_->tick().sensors.image.has_value(); }
  [[nodiscard]] py::object picture() const {
    const flight_log::Tick now = tick();
    if (!now.sensors.image) return py::none();
    const world::CameraTruth& camera = race_.config.sim.camera;
    return py::cast(copied_picture(now.frame.data(), PixelFormat::kUyvy, camera.stored_width,
                                   camera.stored_height, camera.stored_rotation));
  }
  [[nodiscard]] py::object result() const {
    if (!over()) return py::none();
    return python_of(simulated_race::summary(flight_->result(), race_.identity));
  }
  [[nodiscard]] const simulated_race::Race& race() const { return race_; }

 private:
  /// Nobody asks while it flies: another thread, or a signal's handler.
  struct Alone {
    explicit Alone(Race& of) : race{of} {
      race.check_alone();
      race.flying_ = true;
    }
    ~Alone() { race.flying_ = false; }
    Alone(const Alone&) = delete;
    Alone& operator=(const Alone&) = delete;
    Race& race;
  };
  void check_alone() const {
    if (flying_) throw std::runtime_error("the race is being flown by another thread");
  }

  simulated_race::Race race_;
  std::unique_ptr<simulated_race::Flight> flight_;
  bool flying_ = false;  ///< Changes with the interpreter held only.
};

/// Iterator of Race.pictures().
struct Pictures {
  py::object race;
};

void bind_pictures(py::module_& m) {
  py::class_<Pictures>(m, "Pictures", "The pictures of a race, one by one, as they arrive.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", [](const Pictures& pictures) {
        Race& race = pictures.race.cast<Race&>();
        if (!race.step_to_picture()) throw py::stop_iteration();
        return race.picture();
      });
}

}  // namespace

tasks::RenderAgain render_again() { return simulated_race::rendered_again; }

void bind_race(py::module_& m) {
  bind_pictures(m);
  py::class_<Race>(
      m, "Race",
      "A race in the simulator, flown tick by tick: the same as `gatefly fly` with this seed, to "
      "the "
      "bit.\n\n"
      "track: a name in tracks/ or a file; vision: 'rendered' pictures, or 'ideal' detections "
      "without pictures;\nlaps: instead of the track's own number; config, settings: as of a "
      "Detector.")
      .def(py::init([](const py::object& track, const py::object& seed, const std::string& vision,
                       std::optional<int> laps, const py::object& config,
                       const py::object& settings) {
             return std::make_unique<Race>(race_of(track, seed, vision, laps, config, settings));
           }),
           py::arg("track") = "showroom", py::arg("seed") = 1, py::arg("vision") = "rendered",
           py::arg("laps") = py::none(), py::arg("config") = py::none(),
           py::arg("settings") = py::none())
      .def("step", &Race::step,
           "One IMU sample, one step of the pilot. False, and nothing happens, when the race is "
           "over.")
      .def(
          "pictures",
          [](const py::object& self) {
            if (self.cast<Race&>().race().config.vision == simulated_race::Vision::kIdeal)
              throw std::runtime_error("vision = 'ideal': there are no pictures");
            return Pictures{self};
          },
          "An iterator that flies to the next picture and gives it, until the race is over.")
      .def("run", &Race::run, "Flies on to the end. Ctrl-C stops between two ticks.")
      .def("stop", &Race::stop, "Ends the race here, for the reason 'stopped'.")
      .def_property_readonly("over", &Race::over,
                             "Finished, crashed, given up, timed out or stopped.")
      .def_property_readonly(
          "result", &Race::result,
          "What summary.json of `gatefly fly` says; None while the race goes on.")
      .def_property_readonly(
          "time", [](const Race& race) { return seconds(race.tick().sensors.time); },
          "Of the last tick [s].")
      .def_property_readonly(
          "sensors", [](const Race& race) { return race.tick().sensors; },
          "What arrived in the last tick.")
      .def_property_readonly(
          "picture", &Race::picture,
          "The picture that arrived in the last tick, a copy; None where none did.")
      .def_property_readonly(
          "estimate", [](const Race& race) { return race.tick().pilot.estimate(); },
          "What the pilot believes.")
      .def_property_readonly(
          "phase", [](const Race& race) { return name_of(race.tick().pilot.phase()); },
          "What the pilot does, e.g. 'take-off', 'straight', 'turn', 'search'.")
      .def_property_readonly(
          "target_gate", [](const Race& race) { return race.tick().pilot.target_gate(); },
          "Index of the gate it flies to, from 0.")
      .def_property_readonly(
          "command", [](const Race& race) { return race.tick().command; }, "What the pilot wants.")
      .def_property_readonly(
          "sighting", [](const Race& race) { return race.tick().pilot.sighting(); },
          "What became of its last picture.")
      .def_property_readonly(
          "truth", [](const Race& race) { return race.tick().truth; }, "What really is.")
      .def_property_readonly(
          "gates", [](const Race& race) { return race.race().config.pilot.track.gates; },
          "The pilot's map, in flight order; the gates stand a little elsewhere.")
      .def_property_readonly(
          "track", [](const Race& race) { return race.race().identity.track; }, "The track's name.")
      .def_property_readonly(
          "seed", [](const Race& race) { return race.race().identity.seed; },
          "Random seed: from it [randomize] draws the world.")
      .def_property_readonly(
          "vision", [](const Race& race) { return race.race().identity.vision; },
          "'rendered' or 'ideal'.");
}

}  // namespace gatefly::python
