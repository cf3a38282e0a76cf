// Nanoseconds per particle of each kernel, by the number of contacts.
// Prints JSON. See kernels.py.

#include "contact.h"
#include "ring.h"
#include "sector.h"
#include "soft_ring.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>

using namespace deformable;

namespace {

struct Particle {
  std::vector<Contact> contacts;
  std::vector<int> order;
  std::vector<char> is_active;
  Contacts view() const { return {static_cast<int>(contacts.size()), contacts.data()}; }
};

// z contacts at equal spacing, each displaced at random by up to a quarter of it, in random order
std::vector<Particle> particles(int z, std::mt19937 &generator)
{
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Particle> all(2000);
  for (Particle &particle : all) {
    const double turn = 2.0 * PI * uniform(generator);
    for (int c = 0; c < z; ++c) {
      const double theta =
          std::remainder(turn + 2.0 * PI * (c + 0.5 * (uniform(generator) - 0.5)) / z, 2.0 * PI);
      particle.contacts.push_back(
          {theta, std::cos(theta), std::sin(theta), 0.01 + 0.01 * uniform(generator)});
      particle.order.push_back(c);
    }
    std::shuffle(particle.contacts.begin(), particle.contacts.end(), generator);
    particle.is_active.assign(z, 0);
  }
  return all;
}

double sink = 0.0;    // keeps the compiler from leaving the work out

template <class Work> double nanoseconds(std::vector<Particle> &all, Work &&work)
{
  double best = 1e30;    // the least disturbed of many short runs
  for (int repeat = 0; repeat < 100; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (Particle &particle : all) work(particle);
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
    best = std::min(best, time.count() / static_cast<double>(all.size()));
  }
  return best;
}

}    // namespace

int main()
{
  std::mt19937 generator(1);
  Shape shape;
  RingLCP lcp;
  std::printf("[");
  for (int z = 3; z <= 8; ++z) {
    std::vector<Particle> all = particles(z, generator);
    const double geometry = nanoseconds(all, [](const Particle &p) {
      for (const Contact &c : p.contacts) {
        const double d = std::sqrt(c.nx * c.nx + c.ny * c.ny) + c.indentation, per_d = 1.0 / d;
        sink += angle_of(c.nx, c.ny) + contact_line(d, per_d, 0.5, 0.7).indentation;
      }
    });
    const double sector = nanoseconds(all, [&](Particle &p) {
      sector_shape(1.0, p.view(), p.order.data(), shape);
      sink += shape.area_deficit;
    });
    const double area_sector = nanoseconds(all, [&](Particle &p) {
      area_sector_shape(1.0, p.view(), p.order.data(), shape);
      sink += shape.perimeter_excess;
    });
    const double ring = nanoseconds(all, [&](Particle &p) {
      ring_shape(1.0, p.view(), p.is_active.data(), lcp, shape);
      sink += shape.area_deficit;
    });
    const double soft_ring = nanoseconds(all, [&](Particle &p) {
      Energy energy;
      soft_ring_shape(1.0, {1.0, 0.1}, p.view(), p.is_active.data(), lcp, shape, energy);
      sink += energy.value;
    });
    const double general = nanoseconds(all, [&](Particle &p) {
      shape.reset(static_cast<int>(p.contacts.size()), 1.0);
      lcp.clear(static_cast<int>(p.contacts.size()));
      ring_shape_by_lcp(InextensibleRing{1.0}, p.view(), lcp, shape);
      sink += shape.area_deficit;
    });
    std::printf("%s\n{\"z\": %d, \"geometry\": %.1f, \"sector\": %.1f, \"area_sector\": %.1f, "
                "\"ring\": %.1f, \"soft_ring\": %.1f, \"ring_any_number\": %.1f}",
                z > 3 ? "," : "", z, geometry, sector, area_sector, ring, soft_ring, general);
  }
  std::printf("\n]\n");
  return sink == 0.5 ? 1 : 0;
}
