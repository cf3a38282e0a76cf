// Contact law "ring": contacts slip. An inextensible ring, pinned by its Steiner point at the particle's
// centre, is pressed by frictionless contact lines; it takes the shape of largest area.
//
// With H(theta) the support function of the outline, P = int H and A = 1/2 int (H^2 - H'^2), the largest
// A at fixed P and Steiner point under H(theta_c) <= h_c is the convex quadratic programme
//   maximise a.L - 1/2 L.G L over L >= 0,   G_cc' = G(theta_c - theta_c'),
// whose multipliers L are the contact lengths: S = 1/2 a.L, H(theta) = R - sum_c L_c G(theta - theta_c).
// docs/theory.md derives it.

#ifndef DEFORMABLE_RING_H
#define DEFORMABLE_RING_H

#include "shape.h"
#include "trigonometry.h"

#include <algorithm>
#include <limits>

namespace deformable {

// Green function of -u'' - u on the angular modes n >= 2, for 0 <= t <= 2 pi; even and 2 pi periodic:
//   G(t) = [1/2 + cos t/4 - (pi - t) sin t/2]/pi
inline double green(double t, double sine, double cosine)
{
  return (0.5 + 0.25 * cosine - 0.5 * (PI - t) * sine) * (1.0 / PI);
}

// dG/dt, 0 < t < 2 pi; odd, with a jump of -1 at t = 0
inline double d_green(double t, double sine, double cosine)
{
  return (0.25 * sine - 0.5 * (PI - t) * cosine) * (1.0 / PI);
}

constexpr double GREEN_AT_ZERO = 0.75 / PI;

// A quartic in cos t that nowhere exceeds G (and stays within 0.02 of it but for |t| < 0.6): most contacts
// outside of the circle are out of the outline's reach by far, which this tells at a lower price.
inline double green_bound(double cosine)
{
  return -0.094792 +
         cosine * (-0.102549 + cosine * (0.106182 + cosine * (0.116296 + cosine * 0.081933)));
}

// What follows is written once for any number of contacts n and compiled for each small n by itself
// (ring_shape), where all loops unroll: a particle has 3 to 7 contacts, and loops of unknown short length
// would cost more than the arithmetic.
#define DEFORMABLE_INLINE inline __attribute__((always_inline))

// The contacts that may be active, row m of G and G' up to column m.
struct RingCandidates {
  int stride;
  int *contact;    // indices in Contacts
  double *angle, *nx, *ny, *indentation;
  double *green, *d_green;
};

DEFORMABLE_INLINE void add_candidate(const RingCandidates &r, int m, const Contacts &contacts,
                                     int c)
{
  const double theta = contacts[c].angle, x = contacts[c].nx, y = contacts[c].ny;
  r.contact[m] = c;
  r.angle[m] = theta;
  r.nx[m] = x;
  r.ny[m] = y;
  r.indentation[m] = contacts[c].indentation;
#pragma GCC unroll 8
  for (int k = 0; k < m; ++k) {
    // sin |t| from the directions: sin t turns its sign with t
    const double difference = theta - r.angle[k], t = std::fabs(difference);
    const double cosine = r.nx[k] * x + r.ny[k] * y;
    const double cross = r.nx[k] * y - r.ny[k] * x;
    const double sine = difference < 0.0 ? -cross : cross;
    const double slope = d_green(t, sine, cosine);
    r.green[m * r.stride + k] = green(t, sine, cosine);
    r.d_green[m * r.stride + k] = difference < 0.0 ? -slope : slope;
  }
  r.green[m * r.stride + m] = GREEN_AT_ZERO;
}

// x = G^-1 x by L D L^T in place. Returns the row whose pivot vanishes, a direction that the rows before
// it already hold up to rounding, or -1.
DEFORMABLE_INLINE int solve_dense(int n, double *g, int stride, double *x, double *per_pivot)
{
  constexpr double SMALLEST_PIVOT = 1e-13;
#pragma GCC unroll 8
  for (int c = 0; c < n; ++c) {
    const double pivot = g[c * stride + c];
    if (pivot < SMALLEST_PIVOT) return c;
    per_pivot[c] = 1.0 / pivot;
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) {
      const double scaled = g[r * stride + c] * per_pivot[c];
      x[r] -= scaled * x[c];
#pragma GCC unroll 8
      for (int k = c + 1; k <= r; ++k) g[r * stride + k] -= scaled * g[k * stride + c];
    }
  }
#pragma GCC unroll 8
  for (int c = n - 1; c >= 0; --c) {
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) x[c] -= g[r * stride + c] * x[r];
    x[c] *= per_pivot[c];
  }
  return -1;
}

// Can the outline reach a contact outside of the circle? False only where it certainly cannot.
DEFORMABLE_INLINE bool may_reach(const Contacts &contacts, int c, int n, const RingCandidates &r,
                                 const double *length)
{
  double gap = contacts[c].indentation;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m)
    gap -= length[m] * green_bound(r.nx[m] * contacts[c].nx + r.ny[m] * contacts[c].ny);
  return gap > 0.0;
}

// S = 1/2 a.L,  dS/da_c = L_c,  dS/dtheta_c = -L_c sum_{c' != c} L_c' G'(theta_c - theta_c')
// Smallest radius of curvature: q - |m| with q = R - sum L/2 pi and m = (1/pi) sum L_c n_c.
DEFORMABLE_INLINE void fill_shape(double radius, int n, const RingCandidates &r,
                                  const double *length, double *d_angle, Shape &shape)
{
  double sum = 0.0, twice_deficit = 0.0, mx = 0.0, my = 0.0;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    d_angle[m] = 0.0;
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const double pair = length[m] * length[k] * r.d_green[m * r.stride + k];
      d_angle[m] -= pair;
      d_angle[k] += pair;
    }
    sum += length[m];
    twice_deficit += r.indentation[m] * length[m];
    mx += length[m] * r.nx[m];
    my += length[m] * r.ny[m];
  }
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int c = r.contact[m];
    shape.contact[c] = {length[m], length[m], d_angle[m]};
  }
  shape.area_deficit = 0.5 * twice_deficit;
  shape.arc_radius = radius - sum * (0.5 / PI) - std::sqrt(mx * mx + my * my) * (1.0 / PI);
}

// The slack g = a - G L of a contact that carries nothing; negative where the outline stays off its line.
DEFORMABLE_INLINE double slack(const Contacts &contacts, int c, int n, const RingCandidates &r,
                               const double *length)
{
  double gap = contacts[c].indentation;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const double difference = contacts[c].angle - r.angle[m];
    const double cosine = r.nx[m] * contacts[c].nx + r.ny[m] * contacts[c].ny;
    const double cross = r.nx[m] * contacts[c].ny - r.ny[m] * contacts[c].nx;
    gap -= length[m] * green(std::fabs(difference), difference < 0.0 ? -cross : cross, cosine);
  }
  return gap;
}

// Tries the N contacts of `active` (ascending) as those that carry: done where they all push and the
// outline reaches no other. Otherwise leaves in `active` those to be tried next: without the ones that
// would pull or, where none does, with the ones reached.
enum class Trial { DONE, OTHERS, FAILED };

template <int N>
Trial try_active(double radius, const Contacts &contacts, int *active, int &n, Shape &shape)
{
  int contact[N];
  double angle[N], nx[N], ny[N], indentation[N], green[N * N], d_green[N * N];
  double length[N], per_pivot[N];
  const RingCandidates r = {N, contact, angle, nx, ny, indentation, green, d_green};
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    add_candidate(r, m, contacts, active[m]);
    length[m] = indentation[m];
  }
  if (solve_dense(N, green, N, length, per_pivot) >= 0) return Trial::FAILED;

  bool push = true;
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) push &= length[m] >= 0.0;
  if (!push) {
    n = 0;
    for (int m = 0; m < N; ++m)
      if (length[m] > 0.0) active[n++] = contact[m];
    return Trial::OTHERS;
  }
  if (N < contacts.size) {
    n = 0;
    for (int c = 0, m = 0; c < contacts.size; ++c) {
      const bool carries = m < N && contact[m] == c;
      m += carries;
      if (carries ||
          (may_reach(contacts, c, N, r, length) && slack(contacts, c, N, r, length) > 0.0))
        active[n++] = c;
    }
    if (n > N) return Trial::OTHERS;
  }
  fill_shape(radius, N, r, length, per_pivot, shape);
  return Trial::DONE;
}

// Any number of contacts, any of them active: the memory to solve it in.
struct RingProgramme {
  // a DUPLICATE has the direction of a deeper contact
  enum State : char { FREE, ACTIVE, DUPLICATE };

  int size = 0;
  int stride = 0;
  std::vector<int> contact, active;
  std::vector<double> angle, nx, ny, indentation, green, d_green;
  std::vector<State> state;
  std::vector<double> length;    // the solution
  std::vector<double> block, block_length, scratch;
  std::vector<char> violates;
  std::vector<char> candidate;    // by index in Contacts

  void clear(int capacity)
  {
    size = 0;
    if (capacity <= stride) return;
    stride = capacity;
    for (std::vector<int> *v : {&contact, &active}) v->resize(stride);
    for (std::vector<double> *v :
         {&angle, &nx, &ny, &indentation, &length, &block_length, &scratch})
      v->resize(stride);
    state.resize(stride);
    violates.resize(stride);
    candidate.resize(stride);
    for (std::vector<double> *v : {&green, &d_green, &block})
      v->resize(static_cast<std::size_t>(stride) * stride);
  }

  RingCandidates candidates()
  {
    return {stride,    contact.data(),     angle.data(), nx.data(),
            ny.data(), indentation.data(), green.data(), d_green.data()};
  }

  void add(const Contacts &contacts, int c, State as)
  {
    add_candidate(candidates(), size, contacts, c);
    candidate[c] = 1;
    state[size++] = as;
  }

  double between(int m, int k) const { return green[m > k ? m * stride + k : k * stride + m]; }
};

// L = G^-1 a on the active block. Of two contacts in the same direction, the deeper one carries everything.
inline void solve_active(RingProgramme &p)
{
  for (bool again = true; again;) {
    int n = 0;
    for (int m = 0; m < p.size; ++m) {
      p.length[m] = 0.0;
      if (p.state[m] == RingProgramme::ACTIVE) p.active[n++] = m;
    }
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c <= r; ++c) p.block[r * p.stride + c] = p.between(p.active[r], p.active[c]);
      p.block_length[r] = p.indentation[p.active[r]];
    }
    const int row =
        solve_dense(n, p.block.data(), p.stride, p.block_length.data(), p.scratch.data());
    again = row >= 0;
    if (again) {
      const int m = p.active[row];
      int twin = p.active[0];
      for (int c = 1; c < row; ++c)
        if (p.between(m, p.active[c]) > p.between(m, twin)) twin = p.active[c];
      p.state[p.indentation[twin] < p.indentation[m] ? twin : m] = RingProgramme::DUPLICATE;
    } else {
      for (int r = 0; r < n; ++r) p.length[p.active[r]] = p.block_length[r];
    }
  }
}

// L >= 0, g = a - G L <= 0, L.g = 0 by block principal pivoting: exchange every contact that violates its
// condition as long as their number falls, one at a time (Murty's rule, which must end) where it does not.
// J. J. Judice and F. M. Pires, Comput. Oper. Res. 21, 587 (1994).
inline void solve(RingProgramme &p)
{
  constexpr double ROUNDING = 8.0 * std::numeric_limits<double>::epsilon();
  int fewest = p.size + 1, patience = 3;
  for (int iteration = 0; iteration < 100 + 10 * p.size; ++iteration) {
    solve_active(p);

    int violations = 0, last = 0;
    double sum = 0.0;
    for (int m = 0; m < p.size; ++m) sum += std::fabs(p.length[m]);
    for (int m = 0; m < p.size; ++m) {
      p.violates[m] = 0;
      if (p.state[m] == RingProgramme::ACTIVE) {
        p.violates[m] = p.length[m] < 0.0;
      } else if (p.state[m] == RingProgramme::FREE) {
        double gap = p.indentation[m];
        for (int k = 0; k < p.size; ++k) gap -= p.between(m, k) * p.length[k];
        p.violates[m] = gap > ROUNDING * (std::fabs(p.indentation[m]) + sum);
      }
      if (p.violates[m]) {
        ++violations;
        last = m;
      }
    }
    if (violations == 0) return;

    const bool falls = violations < fewest;
    if (falls) {
      fewest = violations;
      patience = 3;
    }
    for (int m = falls || patience-- > 0 ? 0 : last; m < p.size; ++m)
      if (p.violates[m])
        p.state[m] =
            p.state[m] == RingProgramme::ACTIVE ? RingProgramme::FREE : RingProgramme::ACTIVE;
  }
  for (int m = 0; m < p.size; ++m) p.length[m] = std::max(p.length[m], 0.0);
}

// The indented contacts decide how far the outline bulges, and so which others it may reach; those may
// push it on to further ones.
inline void ring_of_any(double radius, const Contacts &contacts, RingProgramme &p, Shape &shape)
{
  std::fill_n(p.candidate.begin(), contacts.size, 0);
  for (int c = 0; c < contacts.size; ++c)
    if (contacts[c].indentation > 0.0) p.add(contacts, c, RingProgramme::ACTIVE);
  for (int solved = 0; p.size > solved;) {
    solve(p);
    solved = p.size;
    for (int c = 0; c < contacts.size; ++c) {
      if (p.candidate[c] || !may_reach(contacts, c, solved, p.candidates(), p.length.data()))
        continue;
      if (slack(contacts, c, solved, p.candidates(), p.length.data()) > 0.0)
        p.add(contacts, c, RingProgramme::FREE);
    }
  }
  fill_shape(radius, p.size, p.candidates(), p.length.data(), p.scratch.data(), shape);
}

// Tries the contacts marked in `carries` first, and leaves there those that do carry: from one force call
// to the next they seldom change. A guess that names none stands for the indented ones.
inline void ring_shape(double radius, const Contacts &contacts, char *carries, RingProgramme &p,
                       Shape &shape)
{
  shape.reset(contacts.size, radius);
  for (int c = 0; c < contacts.size; ++c) shape.contact[c] = {0.0, 0.0, 0.0};
  p.clear(contacts.size);

  int *const active = p.active.data();
  int guessed = 0, indented = 0;
  for (int c = 0; c < contacts.size; ++c) {
    active[guessed] = c;
    guessed += carries[c];
    indented += contacts[c].indentation > 0.0;
  }
  if (indented == 0) {
    std::fill_n(carries, contacts.size, 0);
    return;
  }
  int n = guessed;
  if (guessed == 0)
    for (int c = 0; c < contacts.size; ++c)
      if (contacts[c].indentation > 0.0) active[n++] = c;

  Trial trial = Trial::OTHERS;
  for (int attempt = 0; attempt < 6 && trial == Trial::OTHERS; ++attempt) switch (n) {
      case 1: trial = try_active<1>(radius, contacts, active, n, shape); break;
      case 2: trial = try_active<2>(radius, contacts, active, n, shape); break;
      case 3: trial = try_active<3>(radius, contacts, active, n, shape); break;
      case 4: trial = try_active<4>(radius, contacts, active, n, shape); break;
      case 5: trial = try_active<5>(radius, contacts, active, n, shape); break;
      case 6: trial = try_active<6>(radius, contacts, active, n, shape); break;
      case 7: trial = try_active<7>(radius, contacts, active, n, shape); break;
      default: trial = Trial::FAILED;
    }
  if (trial != Trial::DONE) ring_of_any(radius, contacts, p, shape);
  for (int c = 0; c < contacts.size; ++c) carries[c] = shape.contact[c].length > 0.0;
}

// The outline's support function in one direction:
//   H = R - sum L G,  H' = -sum L G',  rho = H + H'' = q - (1/pi) sum L cos   (between contacts)
struct Support {
  double height, d_height, curvature_radius;
};

inline Support ring_support(double radius, const Contacts &contacts, const Shape &shape,
                            double theta)
{
  Support support = {radius, 0.0, radius};
  for (int c = 0; c < contacts.size; ++c) {
    const double length = shape.contact[c].length;
    if (length == 0.0) continue;
    double t = std::remainder(theta - contacts[c].angle, 2.0 * PI);
    const double sign = t < 0.0 ? -1.0 : 1.0;
    t = std::fabs(t);
    const double sine = std::sin(t), cosine = std::cos(t);
    support.height -= length * green(t, sine, cosine);
    support.d_height -= length * sign * d_green(t, sine, cosine);
    support.curvature_radius -= length * (0.5 + cosine) / PI;
  }
  return support;
}

// Largest H - R: how far the outline reaches out of the circle it came from. The best of 48 directions
// is refined by Newton on H' = 0, with H'' = rho - H.
inline double ring_bulge(double radius, const Contacts &contacts, const Shape &shape)
{
  constexpr int SAMPLES = 48;
  double best = 0.0, at = 0.0;
  for (int k = 0; k < SAMPLES; ++k) {
    const double theta = 2.0 * PI * k / SAMPLES;
    const double height = ring_support(radius, contacts, shape, theta).height - radius;
    if (height > best) {
      best = height;
      at = theta;
    }
  }
  if (best == 0.0) return 0.0;
  for (int step = 0; step < 4; ++step) {
    const Support support = ring_support(radius, contacts, shape, at);
    best = std::max(best, support.height - radius);
    const double second = support.curvature_radius - support.height;
    if (second >= 0.0) break;
    at -= support.d_height / second;
  }
  return best;
}

}    // namespace deformable

#endif
