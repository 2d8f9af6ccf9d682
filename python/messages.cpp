// SPDX-License-Identifier: Apache-2.0
#include "gatefly/race/messages.hpp"

#include <pybind11/stl.h>

#include "gatefly/flight_log/tick.hpp"
#include "gatefly/geometry/seconds.hpp"
#include "gatefly/race/track.hpp"
#include "gatefly/tasks/replay_report.hpp"

#include "arrays.hpp"
#include "bindings.hpp"

// Inputs and outputs of a pilot, and the ground truth; each is a copy.
namespace gatefly::python {
namespace {

/// A member that is a vector or matrix.
template <class Type, class Member>
auto array(Member Type::*member) {
  return [member](const Type& message) { return array_of(message.*member); };
}

template <class Type>
void bind_attitude(py::class_<Type>& type) {
  type.def_property_readonly(
          "roll", [](const Type& m) { return m.attitude.roll; }, "Right side down [rad].")
      .def_property_readonly(
          "pitch", [](const Type& m) { return m.attitude.pitch; }, "Nose up [rad].")
      .def_property_readonly(
          "yaw", [](const Type& m) { return m.attitude.yaw; }, "Clockwise seen from above [rad].");
}

void bind_sensors(py::module_& m) {
  py::class_<Sensors>(m, "Sensors", "What the pilot was told in one tick, its picture apart.")
      .def_property_readonly(
          "time", [](const Sensors& s) { return seconds(s.time); }, "Of the IMU sample [s].")
      .def_property_readonly(
          "time_ns", [](const Sensors& s) { return s.time.count(); }, "The same, exactly [ns].")
      .def_property_readonly(
          "gyro_B", [](const Sensors& s) { return array_of(s.imu.gyro_B); }, "p, q, r [rad/s].")
      .def_property_readonly(
          "accel_B", [](const Sensors& s) { return array_of(s.imu.accel_B); },
          "Specific force [m/s^2]: (0, 0, -9.81) at rest.")
      .def_property_readonly(
          "navigation_gyro_B",
          [](const Sensors& s) {
            return s.navigation_imu ? py::object{array_of(s.navigation_imu->gyro_B)} : py::none();
          },
          "An autopilot's gyro, which the estimator gets [rad/s]; None where none arrived.")
      .def_property_readonly(
          "navigation_accel_B",
          [](const Sensors& s) {
            return s.navigation_imu ? py::object{array_of(s.navigation_imu->accel_B)} : py::none();
          },
          "Its accelerometer [m/s^2]; None where none arrived.")
      .def_readonly("sonar", &Sensors::sonar, "Range along body z [m]; None where none arrived.")
      .def_readonly("baro", &Sensors::baro, "Height above the pad [m]; None where none arrived.")
      .def_readonly("picture_late", &Sensors::picture_late,
                    "So much later than the camera's latency says the picture came, by its stamp "
                    "[s]; 0 also where it has none.");
}

void bind_estimate(py::module_& m) {
  py::class_<Estimate> type(m, "Estimate", "What the pilot believes.");
  type.def_property_readonly("p_EB", array(&Estimate::p_EB), "Position: north, east, down [m].")
      .def_property_readonly("v_E", array(&Estimate::v_E), "Velocity [m/s].")
      .def_property_readonly("accel_bias", array(&Estimate::accel_bias), "[m/s^2]")
      .def_property_readonly("gyro_bias", array(&Estimate::gyro_bias), "[rad/s]")
      .def_property_readonly("p_GB", array(&Estimate::p_GB),
                             "Position in the frame of the target gate [m].")
      .def_property_readonly("covariance_GB", array(&Estimate::covariance_GB),
                             "How sure it is of p_GB (3, 3) [m^2].")
      .def_readonly("gates_passed", &Estimate::gates_passed, "As it believes.");
  bind_attitude(type);
}

void bind_sighting(py::module_& m) {
  py::class_<Sighting>(m, "Sighting", "What became of the pilot's last picture.")
      .def_readonly("seen", &Sighting::seen, "At least one gate was detected.")
      .def_readonly(
          "offered", &Sighting::offered,
          "A gate, or a part of one, gave a fix of the target; the filter may have refused "
          "it.")
      .def_property_readonly(
          "gates",
          [](const Sighting& s) {
            return std::vector<GateDetection>(s.detections.begin(), s.detections.end());
          },
          "Best first.")
      .def_property_readonly(
          "used",
          [](const Sighting& s) { return s.used < 0 ? std::nullopt : std::optional{s.used}; },
          "Index of the gate that corrected the filter; None where none did.")
      .def_property_readonly(
          "source", [](const Sighting& s) { return tasks::name_of(s.source); },
          "What corrected the filter: 'corners', 'bars', or 'predict' where nothing did.");
}

}  // namespace

void bind_messages(py::module_& m) {
  bind_sensors(m);
  bind_estimate(m);
  bind_sighting(m);
  py::class_<Command> command(m, "Command", "What the pilot wants.");
  command
      .def_property_readonly(
          "thrust", [](const Command& c) { return c.attitude.thrust; },
          "Specific thrust, positive lifts [m/s^2].")
      .def_property_readonly(
          "motors",
          [](const Command& c) {
            return py::array_t<double>(static_cast<py::ssize_t>(c.motors.size()), c.motors.data());
          },
          "Rotor speeds: left front, right front, right back, left back [rad/s].");
  bind_attitude(command);
  py::class_<flight_log::Truth> truth(m, "Truth", "What really was. The pilot never sees this.");
  truth
      .def_property_readonly("p_EB", array(&flight_log::Truth::p_EB),
                             "Position: north, east, down [m].")
      .def_property_readonly("v_E", array(&flight_log::Truth::v_E), "Velocity [m/s].");
  bind_attitude(truth);
  py::class_<MapGate>(m, "MapGate", "A gate on the pilot's map.")
      .def_property_readonly("p_EG", array(&MapGate::p_EG), "Centre of the opening [m].")
      .def_readonly("yaw_EG", &MapGate::yaw_EG, "Direction of flight through it [rad].")
      .def_readonly("side", &MapGate::side, "Outer side of the coloured frame [m].");
}

}  // namespace gatefly::python
