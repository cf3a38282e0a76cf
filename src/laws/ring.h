// The ring law of an inextensible ring: contacts slip. The Steiner point of the ring stays at the center of
// the particle. The ring takes the shape of largest area between its contact lines, without friction.
//
// H(theta) is the support function of the outline, P = int H and A = 1/2 int (H^2 - H'^2). The largest A at
// fixed P and Steiner point under H(theta_c) <= h_c is the convex quadratic program
//   maximize a.L - 1/2 L.G L over L >= 0,   G_cc' = G(theta_c - theta_c').
// The solution L is the vector of contact lengths: S = 1/2 a.L, H(theta) = R - sum_c L_c G(theta - theta_c).
// docs/theory/laws.md has the derivation.

#ifndef DEFORMABLE_RING_H
#define DEFORMABLE_RING_H

#include "laws/green.h"
#include "laws/ring_lcp.h"
#include "laws/shape.h"

namespace deformable {

// S = 1/2 a.L,  dS/da_c = L_c,  dS/dtheta_c = -L_c sum_{c' != c} L_c' G'(theta_c - theta_c')
// Smallest radius of curvature: q - |m| with q = R - sum L/2 pi and m = (1/pi) sum L_c n_c.
inline void fill_shape(double radius, RingLCP &p, Shape &shape)
{
  double sum = 0.0, twice_deficit = 0.0, mx = 0.0, my = 0.0;
  const double *const length = p.length.data();
  double *const d_angle = p.scratch.data();
  for (int m = 0; m < p.size; ++m) {
    d_angle[m] = 0.0;
    for (int k = 0; k < m; ++k) {
      const double pair = length[m] * length[k] * p.d_green[m * p.stride + k];
      d_angle[m] -= pair;
      d_angle[k] += pair;
    }
    sum += length[m];
    twice_deficit += p.indentation[m] * length[m];
    mx += length[m] * p.nx[m];
    my += length[m] * p.ny[m];
  }
  for (int m = 0; m < p.size; ++m) shape.contact[p.contact[m]] = {length[m], length[m], d_angle[m]};
  shape.area_deficit = 0.5 * twice_deficit;
  shape.arc_radius = radius - sum * (0.5 / PI) - std::sqrt(mx * mx + my * my) * (1.0 / PI);
}

// A ring that keeps its perimeter. SoftRing in soft_ring.h has the same interface: `expand` computes the
// radial expansion for the contacts that are active.
struct InextensibleRing {
  double radius;
  static constexpr double expansion = 0.0;
  void expand(RingLCP &) const {}
};

// Assumes that the first n contacts in `active` (ascending) are the active ones. That is right where no length is
// negative and the outline reaches no other contact line. Otherwise `active` becomes the next assumption:
// without the contacts of negative length or, if there are none, with the contacts that the outline reaches.
enum class Trial { DONE, OTHERS, FAILED };

template <class Ring>
Trial try_active(Ring &ring, const Contacts &contacts, int &n, RingLCP &p, Shape &shape)
{
  p.size = 0;
  for (int m = 0; m < n; ++m) p.add(contacts, p.active[m], 0.0, RingLCP::ACTIVE);
  std::copy_n(p.indentation.begin(), n, p.length.begin());
  if (solve_dense(n, p.rows(p.green), p.length.data(), p.scratch.data()) >= 0) return Trial::FAILED;
  ring.expand(p);

  n = 0;
  for (int m = 0; m < p.size; ++m)
    if (p.length[m] > 0.0) p.active[n++] = p.contact[m];
  if (!std::all_of(p.length.begin(), p.length.begin() + p.size, [](double L) { return L >= 0.0; }))
    return Trial::OTHERS;
  n = 0;
  for (int c = 0, m = 0; c < contacts.size; ++c) {
    const bool is_active = m < p.size && p.contact[m] == c;
    m += is_active;
    if (is_active || reaches(p, p.size, contacts[c], ring.expansion)) p.active[n++] = c;
  }
  if (n > p.size) return Trial::OTHERS;
  fill_shape(ring.radius + ring.expansion, p, shape);
  return Trial::DONE;
}

// Solves the LCP for all contacts. The indented contacts come first. The outline bulges between them and may
// reach other contact lines, which are added until none is reached.
inline void solve_all(const Contacts &contacts, double expansion, RingLCP &p)
{
  p.size = p.active_count = 0;
  std::fill_n(p.candidate.begin(), contacts.size, 0);
  for (int c = 0; c < contacts.size; ++c)
    if (contacts[c].indentation > -expansion) p.add(contacts, c, expansion, RingLCP::ACTIVE);
  for (int solved = 0; p.size > solved;) {
    solve(p);
    solved = p.size;
    for (int c = 0; c < contacts.size; ++c)
      if (!p.candidate[c] && reaches(p, solved, contacts[c], expansion))
        p.add(contacts, c, expansion, RingLCP::FREE);
  }
}

inline void ring_shape_by_lcp(const InextensibleRing &ring, const Contacts &contacts, RingLCP &p,
                              Shape &shape)
{
  solve_all(contacts, 0.0, p);
  fill_shape(ring.radius, p, shape);
}

// `is_active` holds a first guess of the active contacts, and the active contacts afterwards: from one force
// call to the next they seldom change. A guess without any contact stands for all indented contacts.
template <class Ring>
void ring_shape(Ring &ring, const Contacts &contacts, char *is_active, RingLCP &p, Shape &shape)
{
  shape.circle(contacts.size, ring.radius);
  p.clear(contacts.size);

  int guessed = 0, indented = 0;
  for (int c = 0; c < contacts.size; ++c) {
    p.active[guessed] = c;
    guessed += is_active[c];
    indented += contacts[c].indentation > 0.0;
  }
  if (indented == 0) {
    std::fill_n(is_active, contacts.size, 0);
    return;
  }
  int n = guessed;
  if (guessed == 0)
    for (int c = 0; c < contacts.size; ++c)
      if (contacts[c].indentation > 0.0) p.active[n++] = c;

  Trial trial = Trial::OTHERS;
  for (int attempt = 0; attempt < 6 && trial == Trial::OTHERS; ++attempt)
    trial = n > 0 ? try_active(ring, contacts, n, p, shape) : Trial::FAILED;
  if (trial != Trial::DONE) ring_shape_by_lcp(ring, contacts, p, shape);
  for (int c = 0; c < contacts.size; ++c) is_active[c] = shape.contact[c].length > 0.0;
}

inline void ring_shape(double radius, const Contacts &contacts, char *is_active, RingLCP &p,
                       Shape &shape)
{
  const InextensibleRing ring = {radius};
  ring_shape(ring, contacts, is_active, p, shape);
}

}    // namespace deformable

#endif
