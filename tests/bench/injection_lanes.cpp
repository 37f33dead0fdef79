// Fault injection into runs side by side, LANES at once; the lines marked @ are written by injection_text.py.
#include <stdint.h>
#include <string.h>

#define WIRES_ARE_@WIRES@
enum { ROWS = @ROWS@, POINTS = @POINTS@, RUN_IN = @RUN_IN@, FRAMES = @FRAMES@, BLOCK = @BLOCK@, BLOCKS = (FRAMES - RUN_IN) / BLOCK,
       COUNTED = @COUNTED@, WATCHED = @WATCHED@, LANES = @LANES@, NEVER = INT32_MAX };
#define UNLIKELY(x) __builtin_expect(x, 0)

typedef uint8_t u8;
typedef uint64_t u64;
typedef int32_t i32;
#define INLINE static inline __attribute__((always_inline))
INLINE long clip(long x, long low, long high) { return x < low ? low : x > high ? high : x; }

#ifdef WIRES_ARE_SLICES
typedef u64 wire __attribute__((vector_size(LANES / 8)));
INLINE wire every(bool x) { return wire{} - (u64)x; }
INLINE bool some(wire x) { u64 q[LANES / 64], any = 0; memcpy(q, &x, sizeof q); for (u64 each : q) any |= each; return any; }
INLINE bool in_lane(wire x, int lane) { return x[lane / 64] >> lane % 64 & 1; }
INLINE wire chosen(wire c, wire x, wire y) { return (c & x) | (~c & y); }
INLINE wire most(wire x, wire y, wire z) { return (x & y) | (z & (x | y)); }
struct Masks {
  wire keep[8], turn[8];
  Masks() { for (int k = 0; k < 8; k++) keep[k] = every(1), turn[k] = every(0); }
  void set(int lane, u8 kept, u8 turned) { for (int k = 0; k < 8; k++) put(&keep[k], lane, kept >> k & 1), put(&turn[k], lane, turned >> k & 1); }
  static void put(wire *plane, int lane, u64 bit) { u64 &q = ((u64 *)plane)[lane / 64]; q = (q & ~(1ull << lane % 64)) | bit << lane % 64; }
};
static u64 spread[256];  // of a byte, each bit as a byte of its own
static const bool is_spread = [] { for (int x = 0; x < 256; x++) for (int k = 0; k < 8; k++) spread[x] |= (u64)(x >> k & 1) << 8 * k; return true; }();
struct Tally {
  wire plane[8];
  void add(wire c) { for (int k = 0; k < 8 && some(c); k++) { const wire carry = plane[k] & c; plane[k] ^= c; c = carry; } }
  void into(i32 *counts) const {
    for (int byte = 0; byte < LANES / 8; byte++) {
      u64 sums = 0;
      for (int k = 0; k < 8; k++) sums += spread[((const u8 *)&plane[k])[byte]] << k;
      for (int k = 0; k < 8; k++) counts[8 * byte + k] += sums >> 8 * k & 255;
    }
  }
};
#else
typedef u8 v8 __attribute__((vector_size(LANES)));
typedef int8_t s8 __attribute__((vector_size(LANES)));
typedef u8 v8_half __attribute__((vector_size(LANES / 2)));
typedef int8_t s8_half __attribute__((vector_size(LANES / 2)));
typedef uint16_t u16s __attribute__((vector_size(LANES)));
typedef int16_t s16s __attribute__((vector_size(LANES)));
struct v16 { u16s low, high; };  // two registers: compilers do badly with one vector of twice their width

INLINE v8 v8_of(long x) { return v8{} + (u8)x; }
INLINE v16 v16_of(long x) { return {u16s{} + (uint16_t)x, u16s{} + (uint16_t)x}; }
INLINE v16 operator+(v16 x, v16 y) { return {x.low + y.low, x.high + y.high}; }
INLINE v16 operator-(v16 x, v16 y) { return {x.low - y.low, x.high - y.high}; }
INLINE v16 operator&(v16 x, int y) { return {x.low & (uint16_t)y, x.high & (uint16_t)y}; }
INLINE v8 joined(v8_half low, v8_half high) { v8 x; memcpy(&x, &low, sizeof low); memcpy((char *)&x + sizeof low, &high, sizeof high); return x; }
INLINE v8_half halved(v8 x, int high) { v8_half y; memcpy(&y, (char *)&x + high * sizeof y, sizeof y); return y; }
INLINE v8 to8(v16 x) { return joined(__builtin_convertvector(x.low, v8_half), __builtin_convertvector(x.high, v8_half)); }
INLINE v16 to16(v8 x) { return {__builtin_convertvector(halved(x, 0), u16s), __builtin_convertvector(halved(x, 1), u16s)}; }

#ifdef WIRES_ARE_BYTES
typedef v8 wire;
INLINE wire every(bool x) { return wire{} - (u8)x; }
INLINE bool some(wire x) { u64 q[LANES / 8], any = 0; memcpy(q, &x, sizeof q); for (u64 each : q) any |= each; return any; }
INLINE bool in_lane(wire x, int lane) { return x[lane]; }
INLINE void put(wire *x, int lane, u8 byte) { ((u8 *)x)[lane] = byte; }
INLINE wire narrow(s16s low, s16s high) { return joined((v8_half)__builtin_convertvector(low, s8_half), (v8_half)__builtin_convertvector(high, s8_half)); }
INLINE u16s widened(wire c, int high) { return (u16s)__builtin_convertvector((s8_half)halved(c, high), s16s); }
#define COMPARISON(name, symbol) \
  INLINE wire name(v8 x, v8 y) { return (wire)(x symbol y); } \
  INLINE wire name(v16 x, v16 y) { return narrow(x.low symbol y.low, x.high symbol y.high); }
INLINE wire bit_of(v8 x, int bit) { return (wire)((x & (u8)bit) != 0); }
INLINE v8 chosen(wire c, v8 x, v8 y) { return (c & x) | (~c & y); }
INLINE v16 chosen(wire c, v16 x, v16 y) {
  const u16s low = widened(c, 0), high = widened(c, 1);
  return {(low & x.low) | (~low & y.low), (high & x.high) | (~high & y.high)};
}
INLINE v8 one(wire c) { return c & 1; }
INLINE v8 added(v8 tally, wire c) { return tally - c; }
COMPARISON(less, <) COMPARISON(equal, ==) COMPARISON(at_most, <=)
#else
#include <immintrin.h>
typedef u64 wire;
#define M (__m512i)
INLINE wire every(bool x) { return -(u64)x; }
INLINE bool some(wire x) { return x; }
INLINE bool in_lane(wire x, int lane) { return x >> lane & 1; }
INLINE void put(wire *x, int lane, u8 byte) { *x = (*x & ~(1ull << lane)) | (u64)(byte & 1) << lane; }
#define COMPARISON(name, symbol) \
  INLINE wire name(v8 x, v8 y) { return _mm512_cmp##symbol##_epu8_mask(M x, M y); } \
  INLINE wire name(v16 x, v16 y) { \
    return _mm512_cmp##symbol##_epu16_mask(M x.low, M y.low) | (u64)_mm512_cmp##symbol##_epu16_mask(M x.high, M y.high) << 32; }
INLINE wire bit_of(v8 x, int bit) { return _mm512_test_epi8_mask(M x, _mm512_set1_epi8((char)bit)); }
INLINE wire chosen(wire c, wire x, wire y) { return (c & x) | (~c & y); }
INLINE v8 chosen(wire c, v8 x, v8 y) { return (v8)_mm512_mask_blend_epi8(c, M y, M x); }
INLINE v16 chosen(wire c, v16 x, v16 y) {
  return {(u16s)_mm512_mask_blend_epi16((__mmask32)c, M y.low, M x.low), (u16s)_mm512_mask_blend_epi16((__mmask32)(c >> 32), M y.high, M x.high)};
}
INLINE v8 one(wire c) { return (v8)_mm512_maskz_set1_epi8(c, 1); }
INLINE v8 added(v8 tally, wire c) { return (v8)_mm512_mask_add_epi8(M tally, c, M tally, _mm512_set1_epi8(1)); }
COMPARISON(less, lt) COMPARISON(equal, eq) COMPARISON(at_most, le)
#endif
struct Masks {
  v8 keep, turn;
  wire keep_wire, turn_wire;
  Masks() : keep(v8_of(255)), turn(v8_of(0)), keep_wire(every(1)), turn_wire(every(0)) {}
  void set(int lane, u8 kept, u8 turned) {
    ((u8 *)&keep)[lane] = kept, ((u8 *)&turn)[lane] = turned;
    put(&keep_wire, lane, kept), put(&turn_wire, lane, turned);
  }
};
struct Tally {
  v8 sums;
  void add(wire c) { sums = added(sums, c); }
  void into(i32 *counts) const { for (int k = 0; k < LANES; k++) counts[k] += sums[k]; }
};
#endif

// Batches of LANES runs, each with ROWS faults at most.  sites: (batches, ROWS), -1 for none; keeps, turns, firsts and
// ends: (batches, ROWS, LANES); counts: (batches, COUNTED, BLOCKS, LANES), zero before; seen: (batches, WATCHED, LANES).
extern "C" void run(int batches, const i32 *sites, const u8 *keeps, const u8 *turns, const i32 *firsts, const i32 *ends,
                    i32 *counts, i32 *seen@INPUTS@) {
  static i32 events[FRAMES], following[2 * ROWS * LANES];  // lists of what begins (even) or ends (odd) at a frame
  for (int batch = 0; batch < batches; batch++) {
    const i32 *site = sites + batch * ROWS;
    const size_t base = (size_t)batch * ROWS * LANES;
    u8 at[POINTS] = {0};
    Masks held[ROWS];
    Tally tallies[COUNTED] = {};
    wire before[WATCHED] = {};
    memset(events, -1, sizeof events);
    for (int r = 0; r < ROWS; r++)
      if (site[r] >= 0) {
        at[site[r]] = 1;
        for (int k = 0; k < LANES; k++) {
          const i32 n = r * LANES + k, when[2] = {firsts[base + n], ends[base + n]};
          for (int end = 0; end < 2; end++)
            if (when[end] < FRAMES) following[2 * n + end] = events[when[end]], events[when[end]] = 2 * n + end;
        }
      }
    for (int k = 0; k < WATCHED * LANES; k++) seen[(size_t)batch * WATCHED * LANES + k] = NEVER;
    int tallied = 0;
@START@
    for (int frame = 0; frame < FRAMES; frame++) {
      for (i32 e = events[frame]; UNLIKELY(e >= 0); e = following[e]) {
        const size_t run = base + e / 2;
        held[e / 2 / LANES].set(e / 2 % LANES, e % 2 ? 255 : keeps[run], e % 2 ? 0 : turns[run]);
      }
@STEP@
      if (frame < RUN_IN) continue;
      const wire watched[WATCHED] = {@WATCHED_WIRES@}, counted[COUNTED] = {@COUNTED_WIRES@};
      for (int n = 0; n < WATCHED; n++) {
        const wire now = watched[n] & ~before[n];
        if (UNLIKELY(some(now)))
          for (int k = 0; k < LANES; k++)
            if (in_lane(now, k)) seen[((size_t)batch * WATCHED + n) * LANES + k] = frame - RUN_IN;
        before[n] |= now;
      }
      for (int n = 0; n < COUNTED; n++) tallies[n].add(counted[n]);
      const int measured = frame - RUN_IN + 1;
      if (UNLIKELY(++tallied == 255 || measured % BLOCK == 0)) {
        for (int n = 0; n < COUNTED; n++) {
          i32 *into = counts + (((size_t)batch * COUNTED + n) * BLOCKS + (measured - 1) / BLOCK) * LANES;
          tallies[n].into(into);
          tallies[n] = Tally{};
        }
        tallied = 0;
      }
    }
  }
}
