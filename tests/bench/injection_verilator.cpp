// Fault injection by Verilator, one run after the other, without early exit.  Arguments: asked, answered (files of i32).
// asked: runs, then the inputs (frames each), then for each run the number of its events and these: frame, point, keep,
// turn, in order of frames.  answered: for each run the counts by block of each wire, then the first frames.
#include "Vmachine.h"
#include <stdint.h>
#include <stdio.h>
#include <vector>

enum { POINTS = @POINTS@, RUN_IN = @RUN_IN@, FRAMES = @FRAMES@, BLOCK = @BLOCK@, BLOCKS = (FRAMES - RUN_IN) / BLOCK, COUNTED = @COUNTED@, WATCHED = @WATCHED@ };

static std::vector<int32_t> read_all(const char *path) {
  FILE *file = fopen(path, "rb");
  fseek(file, 0, SEEK_END);
  std::vector<int32_t> words(ftell(file) / 4);
  rewind(file);
  if (fread(words.data(), 4, words.size(), file) != words.size()) return {};
  fclose(file);
  return words;
}

int main(int, char **argument) {
  const std::vector<int32_t> asked = read_all(argument[1]);
  FILE *answered = fopen(argument[2], "wb");
  const int32_t *next = asked.data(), runs = *next++;
@INPUTS@
  for (int run = 0; run < runs; run++) {
    Vmachine machine;
    CData *const keep[POINTS] = {@KEEP@}, *const turn[POINTS] = {@TURN@};
    const uint8_t passing[POINTS] = {@PASSING@};
    for (int k = 0; k < POINTS; k++) *keep[k] = passing[k], *turn[k] = 0;
    int32_t counts[COUNTED][BLOCKS] = {}, first[WATCHED];
    for (int n = 0; n < WATCHED; n++) first[n] = INT32_MAX;
    machine.clk = 0;
    machine.eval();
    int events = *next++;
    for (int frame = 0; frame < FRAMES; frame++) {
      for (; events && next[0] <= frame; events--, next += 4) *keep[next[1]] = next[2], *turn[next[1]] = next[3];
@SET@
      machine.clk ^= 1;
      machine.eval();
      if (frame < RUN_IN) continue;
      const int counted[COUNTED] = {@COUNTED_WIRES@}, watched[WATCHED] = {@WATCHED_WIRES@}, k = frame - RUN_IN;
      for (int n = 0; n < COUNTED; n++) counts[n][k / BLOCK] += counted[n];
      for (int n = 0; n < WATCHED; n++)
        if (watched[n] && k < first[n]) first[n] = k;
    }
    next += 4 * events;
    fwrite(counts, 4, COUNTED * BLOCKS, answered);
    fwrite(first, 4, WATCHED, answered);
  }
  return fclose(answered);
}
