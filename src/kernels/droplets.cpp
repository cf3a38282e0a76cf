// Droplets with given forces, side by side: the formulas of droplet.h and droplet_film.h in vectors. Compiled for each level of
// SIMD instructions, see cmake/sources.cmake.

#include "kernels/force_kernels.h"
#include "kernels/lanes.h"
#include "laws/droplet_film.h"

#include <algorithm>

namespace deformable::DEFORMABLE_LEVEL {

// The logarithm of vectors of doubles, the same on every level of SIMD instructions.
struct Logarithm {
  Lanes value, over;    // ln x, 1/x
};

// artanh(t)/t by powers of t^2: interpolated at Chebyshev's points of t^2 < 0.0295, with an error below 2e-18.
constexpr int TERMS = 8;
constexpr double ARTANH[TERMS] = {1.0,
                                  0.33333333333333826,
                                  0.1999999999965117,
                                  0.1428571438032084,
                                  0.11111098528362971,
                                  0.09091815840117472,
                                  0.07656264074106932,
                                  0.07404855181113693};

// For positive, finite x that are not denormal. x = 2^e a, sqrt(1/2) <= a < sqrt(2):
//   ln a = 2 artanh t,   t = (a - 1)/(a + 1)
DEFORMABLE_LANE_FUNCTION Logarithm logarithm(Lanes x)
{
  typedef unsigned long long Bits __attribute__((vector_size(8 * W)));
  constexpr unsigned long long ONE = 0x3ff0000000000000ULL, FRACTION = 0x000fffffffffffffULL,
                               TO_52 = 0x4330000000000000ULL;    // 2^52
  constexpr double BIAS = 4503599627370496.0 + 1023.0, LN_2 = 0.69314718055994530942;
  const Bits bits = (Bits)x;
  // the exponent as the low bits of a number of the size of 2^52: conversions of integers are slow on older processors
  Lanes exponent = (Lanes)((bits >> 52) | TO_52) - BIAS;
  Lanes a = (Lanes)((bits & FRACTION) | ONE);
  const Mask high = a > 1.41421356237309504880;
  a = select(high, 0.5 * a, a);
  exponent = select(high, exponent + 1.0, exponent);
  const Lanes sum = a + 1.0, quotient = 1.0 / (x * sum);    // one division for both
  const Lanes t = (a - 1.0) * (x * quotient), t2 = t * t;
  Lanes series = all(ARTANH[TERMS - 1]);
  for (int n = TERMS - 2; n >= 0; --n) series = series * t2 + ARTANH[n];
  return {exponent * LN_2 + 2.0 * t * series, sum * quotient};
}

// exp y for y < 700, below 2^-1000 that. y = k ln 2 + r, and the powers of r up to the thirteenth.
DEFORMABLE_LANE_FUNCTION Lanes exponential(Lanes y)
{
  typedef unsigned long long Bits __attribute__((vector_size(8 * W)));
  // 1.5 x 2^52: the low bits of a sum with it are an integer
  constexpr double TO_52 = 6755399441055744.0;
  constexpr double PER_LN_2 = 1.44269504088896340736, LN_2_HIGH = 0.6931471803691238,
                   LN_2_LOW = 1.9082149292705877e-10;
  const Lanes shifted = larger(y * PER_LN_2, all(-1000.0)) + TO_52, k = shifted - TO_52;
  const Lanes r = larger(y, all(-1000.0 / PER_LN_2)) - k * LN_2_HIGH - k * LN_2_LOW;
  constexpr double FACTORIAL[] = {1.0,       1.0,        2.0,         6.0,         24.0,
                                  120.0,     720.0,      5040.0,      40320.0,     362880.0,
                                  3628800.0, 39916800.0, 479001600.0, 6227020800.0};
  Lanes power = all(1.0 / FACTORIAL[13]);
  for (int n = 12; n >= 0; --n) power = power * r + 1.0 / FACTORIAL[n];
  return power * (Lanes)(((Bits)shifted + 1023) << 52);
}

constexpr auto LOG = [](Lanes x) DEFORMABLE_LANE_LAMBDA { return logarithm(x).value; };
constexpr auto EXP = [](Lanes x) DEFORMABLE_LANE_LAMBDA { return exponential(x); };

// A vector in space of each lane.
struct Vectors {
  Lanes x, y, z;
};

DEFORMABLE_LANE_FUNCTION Vectors load_vectors(const double *x, const double *y, const double *z)
{
  return {load<Lanes>(x), load<Lanes>(y), load<Lanes>(z)};
}

DEFORMABLE_LANE_FUNCTION Lanes dot(const Vectors &a, const Vectors &b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Sums over the contacts of a droplet: what W needs of all of them. Q = sum f (n n - 1/3).
struct OfContacts {
  Lanes sum{}, squares{}, cubes{};
  Vectors balance{};    // sum f n
  Lanes xx{}, yy{}, zz{}, xy{}, xz{}, yz{};

  DEFORMABLE_LANE_LAMBDA void add(Lanes f, const Vectors &n)
  {
    const Lanes x = f * n.x, y = f * n.y;
    sum += f;
    squares += f * f;
    cubes += f * f * f;
    balance = {balance.x + x, balance.y + y, balance.z + f * n.z};
    xx += x * n.x;
    xy += x * n.y;
    xz += x * n.z;
    yy += y * n.y;
    yz += y * n.z;
    zz += f * n.z * n.z;
  }
  // Without the trace of Q: once all are added.
  DEFORMABLE_LANE_LAMBDA void finish()
  {
    const Lanes mean = (1.0 / 3.0) * (xx + yy + zz);
    xx -= mean;
    yy -= mean;
    zz -= mean;
  }
  DEFORMABLE_LANE_LAMBDA Vectors times(const Vectors &n) const    // Q n
  {
    return {xx * n.x + xy * n.y + xz * n.z, xy * n.x + yy * n.y + yz * n.z,
            xz * n.x + yz * n.y + zz * n.z};
  }
  DEFORMABLE_LANE_LAMBDA Lanes square() const    // tr Q^2
  {
    return xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + xz * xz + yz * yz);
  }
  DEFORMABLE_LANE_LAMBDA Lanes cube() const    // tr Q^3 = 3 det Q without a trace
  {
    return 3.0 * (xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz));
  }
};

DEFORMABLE_LANE_FUNCTION OfContacts sums_of(const DropletArrays &d, int begin, int end)
{
  OfContacts all;
  for (int c = begin; c < end; c += LANES)
    all.add(load<Lanes>(d.force + c), load_vectors(d.nx + c, d.ny + c, d.nz + c));
  all.finish();
  return all;
}

// What all contacts share; STICKS: some are films.
template <bool STICKS>
DEFORMABLE_LANE_FUNCTION auto load_of(const DropletArrays &d, const OfContacts &all, int begin,
                                      int end)
{
  if constexpr (STICKS) {
    Lanes sum{}, squares{};
    for (int c = begin; c < end; c += LANES) {
      const Lanes s = load<Lanes>(d.sine + c), e = load<Lanes>(d.force + c) + PI * (s * s);
      sum += e;
      squares += e * e;
    }
    return FilmLoad<Lanes>(all.sum, all.squares, sum, squares, LOG, EXP);
  } else {
    return DropletLoad<Lanes>(all.sum, all.squares, LOG, EXP);
  }
}

// Forces and outward normals of the contacts of a batch.
template <bool KNOWN>
static void take_pairs(const RingBatches &b, const DropletArrays &d, const PairDirections &p,
                       int batch)
{
  const int first = b.first[batch], places = b.first[batch + 1] - first;
  const int *const pair_side = b.contacts.pair_side + first;
  double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first,
                *const f = d.force + first;
  double unit[LANES];
  for (int w = 0; w < LANES; ++w)
    unit[w] = 1.0 / (b.rings.radius[batch * LANES + w] * d.tension[batch * LANES + w]);
  for (int c = 0; c < places; ++c) {
    const int k = pair_side[c] >> 1;
    f[c] = unit[c % LANES] * p.force[k];
    if constexpr (KNOWN) continue;
    const double sign = pair_side[c] & 1 ? -1.0 : 1.0;
    nx[c] = sign * p.nx[k];
    ny[c] = sign * p.ny[k];
    nz[c] = sign * p.nz[k];
  }
}

// The sums over the other contacts that W needs: G f, G2 f, (D^16 (2/3) C G2 - G/(4 pi)) f^2, and G' f n. And da/df of each two
// contacts, without what facets that move add to it and without Q: the solver corrects with it. KNOWN: all functions of
// directions, and da/df, are those of the last time.
template <bool KNOWN, class Load>
DEFORMABLE_LANE_FUNCTION void respond(const RingBatches &b, const DropletArrays &d, const Load &of,
                                      int batch, int w)
{
  const int first = b.first[batch], places = b.first[batch + 1] - first;
  double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first,
                *const f = d.force + first, *const tx = d.tx + first, *const ty = d.ty + first,
                *const tz = d.tz + first;
  double *const first_order = static_cast<double *>(b.contacts.scratch),
                *const second = first_order + places, *const third = second + places;
  const Lanes of_cube = (2.0 / 3.0 * CUBE_GREEN2) * of.third;
  [[maybe_unused]] const Lanes of_square = 4.0 * of.x * of.first, of_balance = BALANCE * of.held;
  [[maybe_unused]] float *const taken = d.taken + first;
  std::size_t at = b.first_green[batch] + w;
  for (int c = w; c < places; c += LANES) {
    const Vectors n = load_vectors(nx + c, ny + c, nz + c);
    const Lanes of_c = load<Lanes>(f + c), square_c = of_c * of_c;
    Lanes sum{}, sum_2{}, sum_3{};
    [[maybe_unused]] Lanes of_facets{};
    Vectors moved{};
    for (int k = w; k < c; k += LANES, at += LANES) {
      const Vectors nk = load_vectors(nx + k, ny + k, nz + k);
      const Lanes of_k = load<Lanes>(f + k);
      Lanes g, dg, g2;
      if constexpr (KNOWN) {
        g = load<Lanes>(d.green + at);
        g2 = load<Lanes>(d.green2 + at);
        dg = load<Lanes>(d.d_green + at);
      } else {
        const Lanes m = dot(n, nk), apart = 0.5 - 0.5 * m, q = larger(apart, all(SMALLEST_HALF));
        const Logarithm half = logarithm(q);
        g = droplet_green(m, half.value);
        g2 = droplet_green2(q, half.value);
        dg = select(apart > SMALLEST_APART, d_droplet_green(m, half.value, half.over),
                    all(SLOPE_AT_SMALLEST));
        store(d.green + at, g);
        store(d.green2 + at, g2);
        store(d.d_green + at, dg);
      }
      const Lanes g3 = of_cube * g2 - (0.25 / PI) * g;
      if constexpr (!KNOWN) {
        const Lanes m = dot(n, nk);
        store(b.contacts.green + at,
              g + of_square * g2 + 2.0 * (of_c + of_k) * g3 + of_balance * m);
        const Lanes turns = dg * dg * (1.0 - m * m);
        of_facets += turns * of_k;
        store(taken + k, load<Lanes>(taken + k) + turns * of_c);
      }
      sum += g * of_k;
      sum_2 += g2 * of_k;
      sum_3 += g3 * (of_k * of_k);
      const Lanes by_c = dg * of_c, by_k = dg * of_k;
      moved = {moved.x + by_k * nk.x, moved.y + by_k * nk.y, moved.z + by_k * nk.z};
      store(first_order + k, load<Lanes>(first_order + k) + g * of_c);
      store(second + k, load<Lanes>(second + k) + g2 * of_c);
      store(third + k, load<Lanes>(third + k) + g3 * square_c);
      store(tx + k, load<Lanes>(tx + k) + by_c * n.x);
      store(ty + k, load<Lanes>(ty + k) + by_c * n.y);
      store(tz + k, load<Lanes>(tz + k) + by_c * n.z);
    }
    store(first_order + c, sum);
    store(second + c, sum_2 + GREEN2_AT_ONE * of_c);
    store(third + c, sum_3 + GREEN2_AT_ONE * of_cube * square_c);
    store(tx + c, moved.x);
    store(ty + c, moved.y);
    store(tz + c, moved.z);
    if constexpr (!KNOWN) store(taken + c, of_facets);
  }
}

// And da/df of each contact, as `respond` has those of two. What the facets of others take from it, 1/2 D^4 sum_k f_k (dt_k/df_c)^2
// about, is in `taken`.
template <bool STICKS, class Load>
DEFORMABLE_LANE_FUNCTION void find_compliances(const RingBatches &b, const DropletArrays &d,
                                               const OfContacts &all_of, const Load &of, int batch,
                                               int w)
{
  const int first = b.first[batch], places = b.first[batch + 1] - first,
            droplet = batch * LANES + w;
  const double *const first_order = static_cast<double *>(b.contacts.scratch),
                      *const second = first_order + places, *const logs = second + 2 * places;
  [[maybe_unused]] const double *const of_films = logs + 3 * places;
  const RingArrays &r = b.rings;
  const Lanes per_tension = load<Lanes>(r.per_pressure + droplet),
              least = select((STICKS ? of.held : all_of.sum) > NO_FORCE,
                             LEAST_OF_MEAN * of.facet * (8.0 * PI), all(LEAST_ALONE)),
              l_at_least = LOG_8_PI - logarithm(least).value,
              of_second = (4.0 * BY_SUM) * of.first / of.mixed;
  for (int at = w; at < places; at += LANES) {
    const int c = first + at;
    const Lanes f = load<Lanes>(d.force + c), h = load<Lanes>(second + at);
    Mask bears = f > NO_FORCE;
    if constexpr (STICKS) bears |= load<Lanes>(d.sine + c) > 0.0;
    const Lanes l = select(bears, load<Lanes>(logs + at), l_at_least);
    Lanes own = own_compliance(f, l, load<Lanes>(d.film_log + c), of.stretch) -
                load<Lanes>(first_order + at) * (0.5 / PI) +
                of.x * (BALANCE + 4.0 * GREEN2_AT_ONE * of.first) -
                0.5 * of.first * load<Lanes>(d.taken + c) +
                of.third * ((4.0 / 3.0 * CUBE_GREEN2) * (h + 2.0 * GREEN2_AT_ONE * f) +
                            4.0 * CUBE_FORCES * f);
    if constexpr (STICKS) own += load<Lanes>(of_films + at) + BALANCE * (of.held - of.x);
    const Lanes v = f + of_second * h, rest = v * (2.0 * of.mixed + v * of.square) + of.rate,
                safe = larger(own + rest, all(LEAST_COMPLIANCE));
    store(b.contacts.compliance + c, safe * per_tension * (1.0 / r.scale));
    store(b.contacts.own + c, safe - rest);
    store(b.contacts.share + c, v);
  }
  store(r.square + droplet, -of.square);
  store(r.mixed + droplet, -of.mixed);
  store(r.rate + droplet, of.rate);
}

// What films add to the work, to each a and to each own compliance, and L. Newton's method for L begins with the last one; of its last,
// small step, the work is known to second order, and a to first order. Each lane ends for itself: its neighbors do not matter.
DEFORMABLE_LANE_FUNCTION Lanes load_films(const RingBatches &b, const DropletArrays &d,
                                          const FilmLoad<Lanes> &of, int batch, int w)
{
  constexpr double LEAST_STRETCH = 0.8, MOST_STRETCH = 1.5, CLOSE = 3e-6, VOLUME = 4.0 / 3.0 * PI;
  constexpr int MOST_STEPS = 20;
  const int first = b.first[batch], places = b.first[batch + 1] - first,
            droplet = batch * LANES + w;
  double *const mixed = static_cast<double *>(b.contacts.scratch) + 4 * places,
                *const by_force = mixed + places, *const compliance = by_force + places,
                *const logs = mixed - places;
  const RingArrays &r = b.rings;
  const Lanes X = of.x - of.squares * BY_SUM, radius = load<Lanes>(r.radius + droplet),
              tension = load<Lanes>(d.tension + droplet);
  Lanes curved{};    // what films that are caps add to sum u_P, as of the last time
  for (int at = w; at < places; at += LANES) {
    const int c = first + at;
    if (d.is_cap) curved += load<Lanes>(d.curved_by_pressure + c);
    store(logs + at, logarithm(some_force(load<Lanes>(d.force + c))).value);
  }

  Lanes L = load<Lanes>(d.stretch + droplet), step{}, slope{}, work{}, cover{};
  L = select(L > LEAST_STRETCH, L, all(1.0));    // forces without bound have left none
  Mask going = L > 0.0;
  for (int n = 0; n < MOST_STEPS; ++n) {
    const FilmPressure<Lanes> inside(L, X);
    const Lanes log_P = logarithm(inside.P).value;
    Lanes sum{}, rate{};
    work = cover = Lanes{};
    for (int at = w; at < places; at += LANES) {
      const int c = first + at;
      const Lanes lean = load<Lanes>(d.lean + c);
      const FilmTerm<Lanes> u(load<Lanes>(d.force + c), load<Lanes>(logs + at), inside.P * lean,
                              log_P + load<Lanes>(d.lean_log + c), load<Lanes>(d.sine + c),
                              load<Lanes>(d.rise + c), LOG);
      work += u.u;
      sum += lean * u.P;
      rate += lean * lean * u.PP;
      cover += u.radius * u.radius;
      store(mixed + at, lean * u.fP);
      store(by_force + at, u.f);
      store(compliance + at, u.ff + (L - 1.0) * (0.25 / PI));
      store(d.film_radius + c, radius * u.radius);
    }
    slope = inside.slope;
    const Lanes off = L * L * L - 1.0 + (sum + curved) * (1.0 / VOLUME);
    const Lanes steep = 3.0 * L * L + rate * slope * (1.0 / VOLUME);
    // forces that no droplet bears may have no L: it stays bounded
    step = smaller(larger(Lanes{} - off / larger(steep, all(1.0)), LEAST_STRETCH - L),
                   MOST_STRETCH - L);
    work +=
        work_of_stretch(L, X) - 0.5 * VOLUME * slope * steep * step * step - curved * slope * step;
    going &= magnitude(step) > CLOSE;
    if (!any(going) || n + 1 == MOST_STEPS) break;
    L = select(going, L + step, L);
  }
  L += step;
  const FilmPressure<Lanes> inside(L, X);
  const Lanes pressure = inside.P * tension / radius, unit = radius * tension;
  Lanes pull{};
  for (int at = w; at < places; at += LANES) {
    const int c = first + at;
    const Lanes f = load<Lanes>(d.force + c), sine = load<Lanes>(d.sine + c);
    store(by_force + at, load<Lanes>(by_force + at) + (L - 1.0) * (f * (0.25 / PI) - 1.0) +
                             step * slope * load<Lanes>(mixed + at));
    store(d.least + c, unit * least_of_film(sine, inside.P * load<Lanes>(d.lean + c)));
    if (d.is_cap) store(d.pressure + c, pressure);
    pull += larger(Lanes{} - f, Lanes{});
  }
  store(d.stretch + droplet, L);
  store(d.cover + droplet, 0.25 * cover);
  store(d.bulge + droplet, BULGE_PER_LOAD * larger(of.x + BY_SUM * pull, Lanes{}) +
                               BULGE_PER_PULL * BY_SUM * pull + larger(L - 1.0, Lanes{}));
  return work;
}

// All that a droplet's own forces say: work, indentations and compliances, but for films that turn and facets that move.
template <bool KNOWN, bool STICKS>
static void load_droplets(RingBatches b, DropletArrays d, PairDirections p)
{
  const RingArrays &r = b.rings;
  for (int batch = b.begin; batch < b.end; ++batch) {
    take_pairs<KNOWN>(b, d, p, batch);
    const int first = b.first[batch], places = b.first[batch + 1] - first;
    double *const first_order = static_cast<double *>(b.contacts.scratch),
                  *const second = first_order + places, *const third = second + places,
                  *const logs = third + places, *const beside = logs + places;
    [[maybe_unused]] const double *const of_films = beside + places;
    for (int w = 0; w < LANES; w += W) {
      const int begin = first + w, end = first + places, droplet = batch * LANES + w;
      const OfContacts all_of = sums_of(d, begin, end);
      const auto of = load_of<STICKS>(d, all_of, begin, end);
      Lanes work{};
      if constexpr (STICKS) work = load_films(b, d, of, batch, w);
      respond<KNOWN>(b, d, of, batch, w);

      const Lanes radius = load<Lanes>(r.radius + droplet);
      Lanes turned{}, square{}, cube{};    // T1, J and the sum f^2 G2 f
      for (int c = begin; c < end; c += LANES) {
        const int at = c - first;
        const Lanes f = load<Lanes>(d.force + c), h = load<Lanes>(second + at);
        const Vectors n = load_vectors(d.nx + c, d.ny + c, d.nz + c),
                      moved = load_vectors(d.tx + c, d.ty + c, d.tz + c);
        const Lanes along = dot(moved, n);
        const Vectors t = {along * n.x - moved.x, along * n.y - moved.y, along * n.z - moved.z};
        const Lanes t2 = dot(t, t),
                    l = LOG_8_PI - (STICKS ? load<Lanes>(logs + at)
                                           : logarithm(larger(f, all(NO_FORCE))).value);
        store(logs + at, l);
        store(beside + at, t2);
        turned -= 0.5 * f * t2;
        square += f * h;
        cube += f * f * h;
        work += own_work(f, l, load<Lanes>(d.film_log + c), of.psi) +
                load<Lanes>(first_order + at) * f * (0.5 - f * (0.25 / PI));
        store(d.tx + c, radius * t.x);
        store(d.ty + c, radius * t.y);
        store(d.tz + c, radius * t.z);
        store(d.damping + c, of.damping);
      }
      const Lanes cubic =
          CUBE_TRACE * all_of.cube() + CUBE_FORCES * all_of.cubes + CUBE_GREEN2 * cube;
      const SharedTerms<Lanes> shared(of, turned, square, cubic,
                                      dot(all_of.balance, all_of.balance));
      work += shared.work;

      const Lanes trace = (1.0 / 3.0) * all_of.square();
      for (int c = begin; c < end; c += LANES) {
        const int at = c - first;
        const Lanes f = load<Lanes>(d.force + c), l = load<Lanes>(logs + at),
                    film = load<Lanes>(d.film_log + c), response = load<Lanes>(first_order + at),
                    h = load<Lanes>(second + at);
        const Vectors n = load_vectors(d.nx + c, d.ny + c, d.nz + c), qn = all_of.times(n);
        const Lanes of_trace = 2.0 * CUBE_TRACE * (dot(qn, qn) - trace),
                    of_cube =
                        of_trace + 2.0 * CUBE_FORCES * f * f + (4.0 / 3.0 * CUBE_GREEN2) * f * h;
        Lanes a = own_indentation(f, l, film, of.stretch) + response * (1.0 - f * (0.5 / PI)) +
                  load<Lanes>(third + at) +
                  of.first * (4.0 * of.x * h - 0.5 * load<Lanes>(beside + at)) +
                  of.third * of_cube + BALANCE * of.held * dot(n, all_of.balance) + shared.by_force;
        if constexpr (STICKS) {
          const Lanes sine = load<Lanes>(d.sine + c);
          a += load<Lanes>(of_films + at) + of.tilt * (sine * sine);
        }
        store(d.still + c, radius * a);
      }
      find_compliances<STICKS>(b, d, all_of, of, batch, w);
      store(d.load + droplet, of.x);
      store(d.facet + droplet, of.facet);
      store(r.total + droplet, all_of.sum * radius * load<Lanes>(d.tension + droplet));
      store(d.still_work + droplet, work);
    }
  }
}

// What a film that may turn, and the place of its facet, do to each contact c of a droplet: z_c with d(-W)/dt_c = f_c z_c, and
// the double energy of the turning over F. Both droplets of a pair see opposite ways.
struct Turned {
  Vectors z;
  Lanes twice;    // |R_i t_i - R_j t_j|^2/(R_i + R_j) D_i D_j
};

DEFORMABLE_LANE_FUNCTION Turned turned_film(const RingBatches &b, const DropletArrays &d, int c,
                                            Lanes per_radius)
{
  const int *const partner = b.corrections.partner + c;
  const auto other = [&](const double *x) DEFORMABLE_LANE_LAMBDA {
    return each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return x[partner[w]]; });
  };
  const Vectors here = load_vectors(d.tx + c, d.ty + c, d.tz + c);
  const Vectors way = {here.x - other(d.tx), here.y - other(d.ty), here.z - other(d.tz)};
  const Lanes damping = load<Lanes>(d.damping + c), twice = damping * damping;
  const Lanes part = damping * other(d.damping) * load<Lanes>(d.per_radii + c),
              own = twice * twice * per_radius;
  return {{part * way.x - own * here.x, part * way.y - own * here.y, part * way.z - own * here.z},
          part * dot(way, way)};
}

// Films between droplets of unlike radii: half of their further term to each side. What it adds by the pressure has an effect in
// `load_films` the next time.
DEFORMABLE_LANE_FUNCTION void bend_films(const RingBatches &b, const DropletArrays &d, int batch,
                                         int w)
{
  const int first = b.first[batch], droplet = batch * LANES + w;
  const RingArrays &r = b.rings;
  const Lanes radius = load<Lanes>(r.radius + droplet), tension = load<Lanes>(d.tension + droplet),
              unit = radius * tension, per_volume = 1.0 / (radius * radius * radius);
  Lanes work = load<Lanes>(r.work + droplet);
  for (int c = first + w; c < b.first[batch + 1]; c += LANES) {
    const Lanes is_cap = load<Lanes>(d.is_cap + c), sine = is_cap * load<Lanes>(d.sine + c);
    if (!any(sine > 0.0)) {
      store(d.curved_by_pressure + c, Lanes{});
      continue;
    }
    const int *const partner = b.corrections.partner + c;
    const Lanes here = load<Lanes>(d.pressure + c),
                there =
                    each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return d.pressure[partner[w]]; });
    const CurvedFilm<Lanes> film(unit * load<Lanes>(d.force + c), here, there, tension, sine,
                                 load<Lanes>(d.rise + c), LOG);
    const Mask is = sine > 0.0;
    work += select(is, 0.5 * film.energy, Lanes{});
    double *const a = b.contacts.indentation + c;
    store(a, load<Lanes>(a) + select(is, 0.5 * film.by_force, Lanes{}));
    store(d.curved_by_pressure + c, select(is, film.by_p_i * per_volume, Lanes{}));
  }
  store(r.work + droplet, work);
}

template <bool STICKS> static void turn_films(RingBatches b, DropletArrays d)
{
  const RingArrays &r = b.rings;
  for (int batch = b.begin; batch < b.end; ++batch) {
    const int first = b.first[batch], places = b.first[batch + 1] - first;
    double *const zx = static_cast<double *>(b.contacts.scratch), *const zy = zx + places,
                  *const zz = zy + places, *const back = zz + places, *const free = back + places;
    const double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first,
                        *const f = d.force + first;
    for (int w = 0; w < LANES; w += W) {
      const int droplet = batch * LANES + w;
      const Lanes radius = load<Lanes>(r.radius + droplet), per_radius = 1.0 / radius;
      const double *slope = d.d_green + b.first_green[batch] + w;
      Lanes of_all{};
      for (int c = w; c < places; c += LANES) {
        const Turned turned = turned_film(b, d, first + c, per_radius);
        const Lanes of_c = load<Lanes>(f + c);
        const Vectors n = load_vectors(nx + c, ny + c, nz + c), &z = turned.z;
        of_all += of_c * turned.twice;
        store(free + c, turned.twice);
        store(zx + c, z.x);
        store(zy + c, z.y);
        store(zz + c, z.z);
        Lanes sum{};
        for (int k = w; k < c; k += LANES, slope += LANES) {
          const Lanes dg = load<Lanes>(slope);
          const Vectors nk = load_vectors(nx + k, ny + k, nz + k),
                        zk = load_vectors(zx + k, zy + k, zz + k);
          sum += dg * load<Lanes>(f + k) * dot(zk, n);
          store(back + k, load<Lanes>(back + k) + dg * of_c * dot(z, nk));
        }
        store(back + c, sum);
      }
      const Lanes tension = load<Lanes>(d.tension + droplet);
      const Lanes damped = (0.125 * DECAY * BY_SUM) * of_all;
      for (int c = w; c < places; c += LANES)
        store(b.contacts.indentation + first + c, load<Lanes>(d.still + first + c) +
                                                      0.25 * load<Lanes>(free + c) -
                                                      radius * load<Lanes>(back + c) - damped);
      store(r.work + droplet,
            tension * radius * (radius * load<Lanes>(d.still_work + droplet) + 0.25 * of_all));
      if constexpr (STICKS)
        if (d.is_cap) bend_films(b, d, batch, w);
    }
  }
}

// The derivatives of all works and of turning films by the normals, in energy; only their parts across them count:
//   dW/dn_c = sum_k n_k {f_c f_k [G' (1 - (f_c + f_k)/(4 pi)) + G2' (4 x D^4 + (2/3) C D^16 (f_c + f_k))] - G'' (f_k n_k.v_c +
//     f_c n_c.v_k)}
//     - f_c sum_k G' v_k + v_c sum_k G' m f_k + 4 A D^16 f_c Q^2 n_c + BALANCE x f_c sum f n,   v = f z
// with the G' that t has where it is multiplied by v.
template <bool STICKS> static void derive_droplets(RingBatches b, DropletArrays d)
{
  const RingArrays &r = b.rings;
  for (int batch = b.begin; batch < b.end; ++batch) {
    const int first = b.first[batch], places = b.first[batch + 1] - first;
    double *const vx = static_cast<double *>(b.contacts.scratch), *const vy = vx + places,
                  *const vz = vy + places, *const lever = vz + places;
    const double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first,
                        *const f = d.force + first;
    double *const x = d.torque_x + first, *const y = d.torque_y + first,
                  *const z = d.torque_z + first;
    for (int w = 0; w < LANES; w += W) {
      const int droplet = batch * LANES + w;
      const Lanes radius = load<Lanes>(r.radius + droplet), per_radius = 1.0 / radius;
      const OfContacts all_of = sums_of(d, first + w, first + places);
      const auto of = load_of<STICKS>(d, all_of, first + w, first + places);
      const Lanes of_square = 4.0 * of.x * of.first, of_cube = (2.0 / 3.0 * CUBE_GREEN2) * of.third;
      const double *known = d.d_green + b.first_green[batch] + w;
      for (int c = w; c < places; c += LANES) {
        const Lanes of_c = load<Lanes>(f + c);
        const Vectors n = load_vectors(nx + c, ny + c, nz + c),
                      zc = turned_film(b, d, first + c, per_radius).z;
        const Vectors v = {of_c * zc.x, of_c * zc.y, of_c * zc.z};
        const Vectors qqn = all_of.times(all_of.times(n));
        const Lanes of_trace = 4.0 * CUBE_TRACE * of.third * of_c,
                    of_balance = BALANCE * of.held * of_c;
        Vectors sum = {of_trace * qqn.x + of_balance * all_of.balance.x,
                       of_trace * qqn.y + of_balance * all_of.balance.y,
                       of_trace * qqn.z + of_balance * all_of.balance.z};
        Lanes arm{};
        for (int k = w; k < c; k += LANES, known += LANES) {
          const Vectors nk = load_vectors(nx + k, ny + k, nz + k),
                        vk = load_vectors(vx + k, vy + k, vz + k);
          const Lanes of_k = load<Lanes>(f + k), both = of_c + of_k;
          const Lanes m = dot(n, nk), apart = 0.5 - 0.5 * m, q = larger(apart, all(SMALLEST_HALF));
          const Mask far = apart > SMALLEST_APART;
          const Lanes slope = load<Lanes>(known), over = 1.0 / q;
          // ln q, of which G' is made
          Lanes log_q = 0.5 * m * over - 4.0 / 3.0 - (4.0 * PI) * slope, dg = slope;
          if (any(~far)) {
            log_q = select(far, log_q, logarithm(q).value);
            dg = select(apart > SMALLEST_HALF, select(far, slope, d_droplet_green(m, log_q, over)),
                        Lanes{});
          }
          const Lanes dg2 = d_droplet_green2(q, log_q),
                      bend = select(far, dd_droplet_green(m, over), Lanes{});
          const Lanes by =
              of_c * of_k * (dg * (1.0 - both * (0.25 / PI)) + dg2 * (of_square + of_cube * both)) -
              bend * (of_k * dot(nk, v) + of_c * dot(n, vk));
          const Lanes back = slope * of_c, forth = slope * of_k;
          sum = {sum.x + by * nk.x - back * vk.x, sum.y + by * nk.y - back * vk.y,
                 sum.z + by * nk.z - back * vk.z};
          arm += forth * m;
          store(x + k, load<Lanes>(x + k) + by * n.x - forth * v.x);
          store(y + k, load<Lanes>(y + k) + by * n.y - forth * v.y);
          store(z + k, load<Lanes>(z + k) + by * n.z - forth * v.z);
          store(lever + k, load<Lanes>(lever + k) + back * m);
        }
        store(vx + c, v.x);
        store(vy + c, v.y);
        store(vz + c, v.z);
        store(lever + c, arm);
        store(x + c, sum.x);
        store(y + c, sum.y);
        store(z + c, sum.z);
      }
      const Lanes energy = radius * radius * load<Lanes>(d.tension + droplet);
      for (int c = w; c < places; c += LANES) {
        const Lanes arm = load<Lanes>(lever + c);
        store(x + c, energy * (load<Lanes>(x + c) + arm * load<Lanes>(vx + c)));
        store(y + c, energy * (load<Lanes>(y + c) + arm * load<Lanes>(vy + c)));
        store(z + c, energy * (load<Lanes>(z + c) + arm * load<Lanes>(vz + c)));
      }
    }
  }
}

extern const DropletKernels droplet_kernels, sticking_droplet_kernels;

const DropletKernels droplet_kernels = {load_droplets<false, false>, load_droplets<true, false>,
                                        turn_films<false>, derive_droplets<false>};
const DropletKernels sticking_droplet_kernels = {
    load_droplets<false, true>, load_droplets<true, true>, turn_films<true>, derive_droplets<true>};

}    // namespace deformable::DEFORMABLE_LEVEL
