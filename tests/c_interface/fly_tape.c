/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fly_tape TAPE OUTPUTS TRACK [CONFIG | section.key=value]...
 *
 * Flies a recording that pack_flight made, by gatefly.h and C99 alone; writes what comes out of every step
 * and prints a hash of it. An OUTPUTS of "-" writes nothing. With FLY_TAPE_MARKS=1 getppid() is called before and
 * after each step, for who counts instructions in between (tools/count_steps.py). With FLY_TAPE_MEMORY=1 it says how
 * much memory a pilot takes, and how much stack the steps.
 */
#include <gatefly.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { OUTPUTS = 29, MOST = 16 };

typedef struct {
  uint64_t time_us;
  int64_t picture;
  double gyro[3], accel[3], sonar, baro, looks_on, lifted, motors[4];
} tick;

/* Paints the stack below its caller, or counts from there on to where the paint is whole. */
enum { PAINTED = 1 << 18, PAINT = 0x5a };
__attribute__((noinline)) static size_t stack_below(int paint) {
  volatile unsigned char area[PAINTED];
  size_t i = 0;
  for (; paint && i < PAINTED; ++i) area[i] = PAINT;
  for (i = 0; i < PAINTED && area[i] == PAINT;) ++i;
  return PAINTED - i;
}

static void must(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "fly_tape: %s\n", what);
  exit(2);
}

static void collect(const gatefly_command* c, const gatefly_state* s, double out[OUTPUTS]) {
  const double attitude[5] = {c->roll_rad, c->pitch_rad, c->yaw_rad, c->yaw_rate_radps,
                              c->thrust_mps2};
  memcpy(out, attitude, sizeof attitude);
  memcpy(out + 5, c->motors_radps, sizeof c->motors_radps);
  memcpy(out + 9, c->rates_radps, sizeof c->rates_radps);
  memcpy(out + 12, s->position_m, sizeof s->position_m);
  memcpy(out + 15, s->velocity_mps, sizeof s->velocity_mps);
  memcpy(out + 18, s->attitude_rad, sizeof s->attitude_rad);
  memcpy(out + 21, s->gate_position_m, sizeof s->gate_position_m);
  memcpy(out + 24, s->gate_sigma_m, sizeof s->gate_sigma_m);
  out[27] = s->phase;
  out[28] = s->gates_passed;
}

/* FNV-1a, 64 bit. */
static uint64_t hashed(uint64_t hash, const void* bytes, size_t size) {
  const unsigned char* byte = bytes;
  size_t i;
  for (i = 0; i < size; ++i) hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
  return hash;
}

static void push(gatefly_pilot* pilot, const tick* t, uint32_t width, uint32_t height,
                 const uint8_t* pictures) {
  const uint32_t stamp = (uint32_t)t->time_us;
  const size_t bytes = (size_t)2 * width * height;
  if (t->sonar == t->sonar) gatefly_push_sonar(pilot, stamp, t->sonar);
  if (t->baro == t->baro) gatefly_push_baro(pilot, stamp, t->baro);
  if (t->looks_on > 0)
    gatefly_look_on(pilot, t->lifted > 0, t->motors[0] == t->motors[0] ? t->motors : NULL);
  if (t->picture >= 0)
    must(gatefly_push_image(pilot, stamp, GATEFLY_UYVY, width, height,
                            pictures + bytes * (size_t)t->picture, bytes) == GATEFLY_OK,
         "a picture is refused");
}

int main(int argc, char** argv) {
  gatefly_setup setup = {.struct_size = sizeof setup};
  const char *configs[MOST], *settings[MOST];
  gatefly_pilot* pilot = NULL;
  char error[GATEFLY_ERROR_SIZE];
  uint32_t head[4], i;
  char magic[8];
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  must(argc >= 4 && argc <= 4 + MOST, "usage: fly_tape TAPE OUTPUTS TRACK [CONFIG | key=value]...");
  must(gatefly_abi() == GATEFLY_ABI, "the library is of another version");

  FILE* file = fopen(argv[1], "rb");
  must(file != NULL, "cannot open the tape");
  must(fread(magic, 8, 1, file) == 1 && memcmp(magic, "GFTAPE1", 8) == 0, "not a tape");
  must(fread(head, sizeof head, 1, file) == 1, "the tape is short");
  tick* ticks = malloc(head[0] * sizeof *ticks);
  const size_t bytes = (size_t)2 * head[2] * head[3] * head[1];
  uint8_t* pictures = malloc(bytes + 1);
  must(ticks != NULL && pictures != NULL, "no memory");
  must(fread(ticks, sizeof *ticks, head[0], file) == head[0], "the tape is short");
  must(fread(pictures, 1, bytes, file) == bytes, "the tape is short");
  fclose(file);

  for (int a = 4; a < argc; ++a) {
    if (strchr(argv[a], '=') != NULL)
      settings[setup.setting_count++] = argv[a];
    else
      configs[setup.config_count++] = argv[a];
  }
  setup.track = argv[3], setup.configs = configs, setup.settings = settings;
  void* memory = malloc(gatefly_size());
  must(memory != NULL, "no memory");
  if (gatefly_create(memory, gatefly_size(), &setup, &pilot, error, sizeof error) != GATEFLY_OK)
    must(0, error);

  const int marks = getenv("FLY_TAPE_MARKS") != NULL,
            memory_asked = getenv("FLY_TAPE_MEMORY") != NULL;
  if (memory_asked) { /* a second pilot: what the first one leaves is tables of the reader of files */
    gatefly_destroy(pilot);
    const size_t before = mallinfo2().uordblks;
    must(gatefly_create(memory, gatefly_size(), &setup, &pilot, error, sizeof error) == GATEFLY_OK,
         "no second pilot");
    printf("a pilot: %u bytes of the caller's, %u allocated\n", (unsigned)gatefly_size(),
           (unsigned)(mallinfo2().uordblks - before));
  }
  FILE* outputs = strcmp(argv[2], "-") == 0 ? NULL : fopen(argv[2], "wb");
  if (memory_asked) (void)stack_below(1);
  for (i = 0; i < head[0]; ++i) {
    gatefly_command command = {.struct_size = sizeof command};
    gatefly_state state = {.struct_size = sizeof state};
    double out[OUTPUTS];
    push(pilot, &ticks[i], head[2], head[3], pictures);
    if (marks) (void)getppid();
    const gatefly_status status =
        gatefly_step(pilot, (uint32_t)ticks[i].time_us, ticks[i].gyro, ticks[i].accel, &command);
    if (marks) (void)getppid();
    must(status == GATEFLY_OK, "a step is refused");
    must(gatefly_get_state(pilot, &state) == GATEFLY_OK, "no state");
    must(state.time_us == ticks[i].time_us, "the clock went astray");
    collect(&command, &state, out);
    hash = hashed(hash, out, sizeof out);
    if (outputs != NULL) must(fwrite(out, sizeof out, 1, outputs) == 1, "cannot write");
  }
  if (memory_asked) printf("stack: %u bytes\n", (unsigned)stack_below(0));
  must(outputs == NULL || fclose(outputs) == 0, "cannot write");
  printf("%016llx %u steps, %u pictures\n", (unsigned long long)hash, head[0], head[1]);
  gatefly_destroy(pilot);
  free(memory);
  free(ticks);
  free(pictures);
  return 0;
}
