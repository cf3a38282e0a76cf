// Runs the kernels on the contacts of standard input, and on random ones, for compilers that check memory
// and arithmetic. Input: `radius z`, then z lines `angle indentation`, and so on. Ends with an error where
// an answer is not finite.

#include "laws/contact.h"
#include "laws/friction.h"
#include "laws/ring.h"
#include "laws/sector.h"
#include "laws/soft_ring.h"
#include "response/droplet_blocks.h"
#include "response/outline.h"
#include "response/ring_blocks.h"

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <random>

using namespace deformable;

namespace {

int checked = 0;

void require(bool good, const char *what, const std::vector<Contact> &contacts)
{
  ++checked;
  if (good) return;
  std::fprintf(stderr, "%s is not right for %zu contacts:\n", what, contacts.size());
  for (const Contact &c : contacts) std::fprintf(stderr, "%.17g %.17g\n", c.angle, c.indentation);
  std::exit(1);
}

bool finite(const Shape &shape, int z)
{
  bool good = std::isfinite(shape.area_deficit) && std::isfinite(shape.perimeter_excess) &&
              std::isfinite(shape.arc_radius);
  for (int c = 0; c < z; ++c)
    good = good && std::isfinite(shape.contact[c].length) &&
           std::isfinite(shape.contact[c].d_indentation) && std::isfinite(shape.contact[c].d_angle);
  return good;
}

bool finite(const Outline &outline)
{
  for (const double x : outline.xy)
    if (!std::isfinite(x)) return false;
  return true;
}

// One memory for all particles, as in a force loop.
struct Kernels {
  Shape shape;
  RingLCP lcp;
  std::vector<int> order;
  std::vector<char> is_active;
  RingHessian hessian;

  void ring(double radius, const std::vector<Contact> &memory)
  {
    const Contacts contacts = {static_cast<int>(memory.size()), memory.data()};
    ring_shape(radius, contacts, is_active.data(), lcp, shape);
    require(finite(shape, contacts.size), "ring", memory);
    const double cold = shape.area_deficit;

    // what carried is the next guess, and so is anything else: the answer does not depend on it
    for (int guess = 0; guess < 3; ++guess) {
      ring_shape(radius, contacts, is_active.data(), lcp, shape);
      require(std::fabs(shape.area_deficit - cold) <= 1e-10 * cold, "ring with a guess", memory);
      for (std::size_t c = 0; c < memory.size(); ++c) is_active[c] = (c + guess) % 2;
    }
    Outline outline;
    ring_outline(radius, contacts, shape, order.data(), 60, outline);
    require(finite(outline), "ring outline", memory);
    require(std::isfinite(ring_bulge(radius, contacts, shape)), "ring bulge", memory);
  }

  void soft_ring(double radius, const Stiffness &stiffness, const std::vector<Contact> &memory)
  {
    const Contacts contacts = {static_cast<int>(memory.size()), memory.data()};
    double cold = 0.0;
    for (int guess = 0; guess < 4; ++guess) {
      Energy energy;
      const bool exists =
          soft_ring_shape(radius, stiffness, contacts, is_active.data(), lcp, shape, energy);
      require(exists || std::isinf(stiffness.kA), "soft ring", memory);
      if (!exists) return;
      require(finite(shape, contacts.size) && std::isfinite(energy.value) &&
                  std::isfinite(energy.derivative),
              "soft ring", memory);
      if (shape.arc_radius < 0.0) return;
      if (guess == 0) cold = energy.value;
      require(std::fabs(energy.value - cold) <= 1e-10 * cold, "soft ring with a guess", memory);
      check_stiffness(radius, stiffness, energy.derivative, memory);
      for (std::size_t c = 0; c < memory.size(); ++c) is_active[c] = (c + guess) % 2;
    }
  }

  void check_stiffness(double radius, const Stiffness &stiffness, double pressure,
                       const std::vector<Contact> &memory)
  {
    const Contacts contacts = {static_cast<int>(memory.size()), memory.data()};
    std::vector<int> active;
    for (int c = 0; c < contacts.size; ++c)
      if (shape.contact[c].length > 0.0) active.push_back(c);
    const int n = static_cast<int>(active.size());
    std::vector<double> inverse(n * n), rate, matrix(n * n);
    green_inverse(contacts, n, active.data(), lcp, inverse.data());
    const RingState ring = {radius,    shape.perimeter_excess / (2.0 * PI),
                            stiffness, pressure,
                            contacts,  shape.contact.data()};
    contact_stiffness(ring, n, active.data(), inverse.data(), rate, matrix.data());
    for (const double k : matrix) require(std::isfinite(k), "contact stiffness", memory);
    ring_hessian(ring, n, active.data(), hessian);
    for (const double k : hessian.block) require(std::isfinite(k), "ring Hessian", memory);
  }

  void sectors(double radius, const std::vector<Contact> &memory)
  {
    const Contacts contacts = {static_cast<int>(memory.size()), memory.data()};
    sector_shape(radius, contacts, order.data(), shape);
    require(finite(shape, contacts.size), "sector", memory);
    Outline outline;
    sector_outline(radius, contacts, order.data(), 60, outline,
                   [](const Opening &o, double ai, double ak) {
                     return sector(sector_coefficients(o), ai, ak);
                   });
    require(finite(outline), "sector outline", memory);
    if (area_sector_shape(radius, contacts, order.data(), shape))
      require(finite(shape, contacts.size), "area sector", memory);
  }

  void operator()(double radius, const std::vector<Contact> &memory, bool distinct)
  {
    is_active.assign(memory.size(), 0);
    order.resize(memory.size());
    std::iota(order.begin(), order.end(), 0);
    ring(radius, memory);
    for (const double ratio : {1e-6, 1e-2, 1.0, 1e12}) soft_ring(radius, {1.0, ratio}, memory);
    soft_ring(radius, {std::numeric_limits<double>::infinity(), 1.0}, memory);
    if (distinct) sectors(radius, memory);
  }
};

Contact contact(double angle, double indentation)
{
  return {angle, std::cos(angle), std::sin(angle), indentation};
}

// Contacts that rub, with coefficients of any size, 0 and inf among them.
template <class Uniform> void rubs(Uniform uniform)
{
  const auto some = [&] {
    return uniform(0.0, 1.0) < 0.2 ? 0.0 : std::pow(10.0, uniform(-9.0, 9.0));
  };
  const double infinity = std::numeric_limits<double>::infinity();
  const Friction c = {uniform(0.0, 1.0) < 0.1 ? infinity : some(), some(), some(), some()};
  require(invalid_friction(c).empty() && largest_time_step(c, 1.0, 3.0) > 0.0, "friction", {});
  const double dt = std::pow(10.0, uniform(-6.0, 0.0));
  Rub<Vector3> before = {};
  for (int step = 0; step < 20; ++step) {
    const double normal = uniform(-0.1, 1.0);
    const Vector3 way = {dt * uniform(-1.0, 1.0), dt * uniform(-1.0, 1.0), dt * uniform(-1.0, 1.0)};
    const Rub<Vector3> now = rub(c, before.xi, way, dt, normal);
    const RubLoss lost = loss(c.kt, before, now, way);
    require(std::isfinite(length(now.xi + now.force) + lost.sliding + lost.dashpot), "rub", {});
    require(length(now.force) <= 1.000001 * most_friction(c.mu, normal), "Coulomb's bound", {});
    const double damped = damping(c.gn, way.x, dt, normal);
    require(std::isfinite(damped) && damped <= std::max(normal, 0.0), "damping", {});
    before = now;
  }
}

// A droplet in space between contacts of any forces, some of them nearly in one place.
template <class Uniform> void droplet(Uniform uniform)
{
  const double radius = uniform(0.1, 2.0), tension = uniform(0.1, 10.0);
  std::vector<DropletSide> sides(static_cast<std::size_t>(uniform(0.0, 9.0)));
  for (std::size_t c = 0; c < sides.size(); ++c) {
    const double away = c % 5 == 4 ? std::pow(10.0, uniform(-16.0, -3.0)) : 2.0;
    for (int a = 0; a < 3; ++a)
      sides[c].vector.v[a] =
          (away < 1.0 ? sides[c - 1].vector.v[a] : 0.0) + away * uniform(-1.0, 1.0);
    sides[c].overlap = uniform(-1.0, 1.0);
    sides[c].film = uniform(-2.0, 2.0);
    for (double &weight : sides[c].weight) weight = uniform(-1.0, 1.0);
    sides[c].force = radius * tension * std::pow(10.0, uniform(-12.0, 0.5));
  }
  EnergyBlocks blocks, facets;
  ParameterBlocks parameters;
  add_droplet(sides, radius, tension, true, blocks, facets, &parameters);
  bool good = std::isfinite(blocks.energy);
  for (const double value : blocks.value) good = good && std::isfinite(value);
  for (const double value : facets.value) good = good && std::isfinite(value);
  for (const double value : blocks.gradient) good = good && std::isfinite(value);
  for (const double value : parameters.value) good = good && std::isfinite(value);
  require(good, "droplet", {});
}

}    // namespace

int main()
{
  Kernels kernels;
  double radius, angle, indentation;
  int z;
  while (std::cin >> radius >> z) {
    std::vector<Contact> contacts;
    for (int c = 0; c < z && std::cin >> angle >> indentation; ++c)
      contacts.push_back(contact(angle, indentation));
    kernels(radius, contacts, true);
  }

  std::mt19937 random(1);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int trial = 0; trial < 250; ++trial) {
    std::vector<Contact> contacts;
    const int size = static_cast<int>(uniform(0.0, trial % 10 ? 10.0 : 41.0));
    for (int c = 0; c < size; ++c)
      contacts.push_back(contact(uniform(-PI, PI), uniform(-0.01, 0.1)));
    kernels(1.0, contacts, true);

    // twins: the same direction, or one that rounding hardly tells apart
    for (int c = 0; c < size; c += 2) {
      const double apart = c % 4 ? 0.0 : std::pow(10.0, uniform(-16.0, -6.0));
      contacts.push_back(contact(contacts[c].angle + apart * (contacts[c].angle < 0.0 ? 1 : -1),
                                 contacts[c].indentation + (c % 3) * 1e-9));
    }
    kernels(1.0, contacts, false);
  }

  for (int trial = 0; trial < 1000; ++trial) rubs(uniform);
  for (int trial = 0; trial < 60; ++trial) droplet(uniform);
  for (int trial = 0; trial < 1000; ++trial) {
    const double ri = uniform(0.1, 2.0), rj = uniform(0.1, 2.0), d = (ri + rj) * uniform(0.5, 1.2);
    const ContactLine line = contact_line(d, 1.0 / d, ri, rj);
    require(std::isfinite(line.indentation), "contact line", {});
  }

  // the two replacements of exact functions: where they hold, and how closely
  constexpr int STEPS = 10000;
  for (int k = 0; k <= STEPS; ++k) {
    const double t = PI * k / STEPS, g = green(t, std::sin(t), std::cos(t));
    const double below = g - green_bound(std::cos(t));
    require(below >= 0.0, "green_bound exceeds G", {});
    require(t < 0.6 || below < 0.02, "green_bound is far below G", {});
    for (const double theta : {t, -t, t * 1e-9, PI - t * 1e-9}) {
      const double x = 3.0 * std::cos(theta), y = 3.0 * std::sin(theta);
      require(std::fabs(angle_of(x, y) - std::atan2(y, x)) <= 4.5e-16, "angle_of", {});
    }
  }
  for (const double x : {-2.0, 0.0, 2.0})
    for (const double y : {-2.0, 0.0, 2.0})
      require((x == 0.0 && y == 0.0) || angle_of(x, y) == std::atan2(y, x), "angle_of an axis", {});
  std::printf("%d checks\n", checked);
}
