/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pilot_loop_c TRACK CONFIG...: the pilot in a loop of yours, in C. The sensors here are those of a drone that is
 * held on the floor: the pilot starts, sees that it does not climb, and gives up.
 */
#include <gatefly.h>
#include <stdio.h>
#include <string.h>

/* Yours: waits for the next IMU sample; microseconds may wrap. x forward, y right, z down. */
static uint32_t read_imu(int tick, double gyro[3], double accel[3]) {
  memset(gyro, 0, 3 * sizeof *gyro);
  accel[0] = accel[1] = 0.0;
  accel[2] = tick % 2 == 0 ? -9.81 : -9.812; /* a sensor that repeats itself is taken for stuck */
  return (uint32_t)(1953.125 * tick);        /* 512 Hz */
}

/* Yours: rad/s of left front, right front, right back, left back. */
static void set_motors(const double speeds[4]) { (void)speeds; }

static gatefly_pilot* made(int argc, const char** argv) {
  gatefly_setup setup = {.struct_size = sizeof setup, .track = argc > 1 ? argv[1] : "showroom"};
  gatefly_pilot* pilot = NULL;
  char error[GATEFLY_ERROR_SIZE];
  if (argc > 2) setup.configs = argv + 2, setup.config_count = (uint32_t)argc - 2;
  if (gatefly_create(NULL, 0, &setup, &pilot, error, sizeof error) != GATEFLY_OK)
    fprintf(stderr, "%s\n", error);
  return pilot;
}

int main(int argc, char** argv) {
  static const char* const phases[] = {"ground", "take-off", "straight", "turn",
                                       "search", "land",     "landed"};
  gatefly_command command = {.struct_size = sizeof command};
  gatefly_state state = {.struct_size = sizeof state, .phase = GATEFLY_LANDED};
  gatefly_pilot* pilot = made(argc, (const char**)argv);
  if (pilot == NULL || gatefly_abi() != GATEFLY_ABI) return 2;
  uint32_t before = GATEFLY_LANDED;
  for (int tick = 0; tick == 0 || state.phase != GATEFLY_LANDED; ++tick) {
    double gyro[3], accel[3];
    const uint32_t time_us = read_imu(tick, gyro, accel);
    gatefly_push_sonar(pilot, time_us, tick % 2 == 0 ? 0.050 : 0.052);
    /* A picture is pushed before the sample in whose time it arrives: gatefly_push_image(). */
    gatefly_step(pilot, time_us, gyro, accel, &command);
    set_motors(command.motors_radps);
    gatefly_get_state(pilot, &state);
    if (state.phase != before)
      printf("%.6g s: %s\n", 1e-6 * (double)state.time_us, phases[state.phase]);
    before = state.phase;
  }
  puts(state.abort_reason == GATEFLY_NO_CLIMB ? "the drone did not climb" : "ended");
  gatefly_destroy(pilot);
  return 0;
}
