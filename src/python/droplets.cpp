#include "python/laws.h"

#include "kernels/batch_kernels.h"
#include "laws/droplet.h"
#include "response/droplet_blocks.h"

#include <nanobind/stl/string.h>

#include <array>
#include <cmath>

using namespace deformable;

namespace {

// One droplet, as the kernels know it.
struct Droplet {
  double radius, tension, load, facet, work;
  std::size_t contacts;
  std::vector<double> nx, ny, nz, f, indentation, tx, ty, tz;

  double energy() const
  {
    double sum = -work;
    for (std::size_t c = 0; c < contacts; ++c) sum += force(c) * indentation[c];
    return sum;
  }
  double force(std::size_t c) const { return f[c] * radius * tension; }
  double pressure() const
  {
    double moment = 0.0;
    for (std::size_t c = 0; c < contacts; ++c) moment += force(c) * (radius - indentation[c]);
    return droplet_pressure(radius, tension, energy(), moment);
  }

  // da/dF
  std::vector<double> compliance() const
  {
    std::vector<std::array<Dual, 3>> n(contacts);
    for (std::size_t c = 0; c < contacts; ++c) n[c] = {nx[c], ny[c], nz[c]};
    std::vector<Dual> forces(contacts);
    for (std::size_t c = 0; c < contacts; ++c) forces[c] = Dual::variable(f[c], c, contacts);
    const LoadedDroplet<Dual> loaded(forces, n, std::vector<double>(contacts),
                                     std::vector<std::array<Dual, 3>>(contacts));
    std::vector<double> matrix;
    for (const Dual &a : loaded.indentation)
      for (const double by : a.by) matrix.push_back(by / tension);
    return matrix;
  }
};

std::vector<double> normals_of(nb::handle given)
{
  std::vector<double> numbers = flat_vector_of("normals", given);
  if (numbers.size() % 3 != 0) refuse("normals must have 3 numbers for each contact");
  for (std::size_t c = 0; c < numbers.size(); c += 3) {
    double *const n = &numbers[c];
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0.0))
      refuse("normal " + std::to_string(c / 3) + " is 0: a contact needs a direction");
    for (int axis = 0; axis < 3; ++axis) n[axis] /= length;
  }
  return numbers;
}

Droplet droplet(nb::handle given_normals, nb::handle given_forces, double radius, double tension,
                const std::string &level)
{
  require_positive("radius", radius);
  require_positive("tension", tension);
  const std::vector<double> normals = normals_of(given_normals),
                            forces = vector_of("forces", given_forces);
  const std::size_t z = forces.size();
  if (normals.size() != 3 * z) refuse("forces must have one value for each normal");
  const BatchKernels *const kernels = batch_kernels(level);
  if (!kernels) refuse(why_no_kernels("level", level));

  std::vector<double> force(z + 1), x(z + 1), y(z + 1), n(z + 1);
  for (std::size_t c = 0; c < z; ++c) {
    if (!(forces[c] >= 0.0))
      refuse("force " + std::to_string(c) + " is negative: droplets do not stick");
    force[c] = forces[c];
    x[c] = normals[3 * c];
    y[c] = normals[3 * c + 1];
    n[c] = normals[3 * c + 2];
  }
  // the other lanes of its batch have no contacts
  const std::size_t places = z * LANES, greens = z * (z - std::min<std::size_t>(z, 1)) / 2 * LANES,
                    first_green[] = {0, greens};
  const int size = static_cast<int>(z), first[] = {0, size * LANES}, none = 2 * size;
  std::vector<int> pair_side(places, none);
  for (std::size_t c = 0; c < z; ++c) pair_side[c * LANES] = 2 * static_cast<int>(c);
  const auto room = [&] { return std::vector<double>(places + 1); };
  std::vector<double> nx = room(), ny = room(), nz = room(), f = room(), still = room(), a = room(),
                      tx = room(), ty = room(), tz = room(), damping = room(), film = room(),
                      per_radii = room(), x_turn = room(), y_turn = room(), z_turn = room(),
                      each_green(greens), each_green2(greens), d_green(greens), scratch(5 * places);
  std::vector<double> radii(LANES, 1.0), tensions(LANES, 1.0), per_tension(LANES, 1.0), load(LANES),
      facet(LANES), work(LANES), still_work(LANES), total(LANES);
  radii[0] = radius;
  tensions[0] = tension;
  per_tension[0] = 1.0 / tension;
  std::vector<float> taken(places), square(LANES), mixed(LANES), rate(LANES), share(places),
      compliance(places), each(places), green(greens);
  const std::vector<int> partner(places, static_cast<int>(places));    // walls
  RingBatches batch = {};
  batch.end = 1;
  batch.size = &size;
  batch.first = first;
  batch.first_green = first_green;
  batch.rings.radius = radii.data();
  batch.rings.work = work.data();
  batch.rings.total = total.data();
  batch.rings.per_pressure = per_tension.data();
  batch.rings.square = square.data();
  batch.rings.mixed = mixed.data();
  batch.rings.rate = rate.data();
  batch.rings.scale = 1.0;
  batch.contacts.pair_side = pair_side.data();
  batch.contacts.indentation = a.data();
  batch.contacts.compliance = compliance.data();
  batch.contacts.share = share.data();
  batch.contacts.green = green.data();
  batch.contacts.own = each.data();
  batch.contacts.scratch = scratch.data();
  batch.corrections.partner = partner.data();
  DropletArrays arrays = {};
  arrays.tension = tensions.data();
  arrays.film_log = film.data();
  arrays.per_radii = per_radii.data();
  arrays.load = load.data();
  arrays.facet = facet.data();
  arrays.still_work = still_work.data();
  arrays.still = still.data();
  arrays.nx = nx.data();
  arrays.ny = ny.data();
  arrays.nz = nz.data();
  arrays.force = f.data();
  arrays.tx = tx.data();
  arrays.ty = ty.data();
  arrays.tz = tz.data();
  arrays.damping = damping.data();
  arrays.torque_x = x_turn.data();
  arrays.torque_y = y_turn.data();
  arrays.torque_z = z_turn.data();
  arrays.taken = taken.data();
  arrays.green = each_green.data();
  arrays.green2 = each_green2.data();
  arrays.d_green = d_green.data();
  PairDirections pairs = {};
  pairs.force = force.data();
  pairs.nx = x.data();
  pairs.ny = y.data();
  pairs.nz = n.data();
  kernels->droplets.shape(batch, arrays, pairs);
  kernels->droplets.turn(batch, arrays);
  kernels->droplets.derive(batch, arrays);
  const auto own = [&](const std::vector<double> &by_place) {
    std::vector<double> found(z);
    for (std::size_t c = 0; c < z; ++c) found[c] = by_place[c * LANES];
    return found;
  };
  return {radius,  tension, load[0], facet[0], work[0],     z,           own(nx),
          own(ny), own(nz), own(f),  own(a),   own(x_turn), own(y_turn), own(z_turn)};
}

}    // namespace

void deformable::bind_droplets(nb::module_ &m)
{
  m.attr("largest_bulge") = LARGEST_BULGE;
  m.attr("droplet_decay") = DECAY;
  nb::class_<Droplet>(m, "Droplet", "A droplet in three dimensions that bears given forces.")
      .def_ro("load", &Droplet::load, "x = sum F/(8 pi g R), the part that facets would cover")
      .def_ro("facet", &Droplet::facet,
              "y = sum F^2/(8 pi g R sum F), the part that the mean facet would cover")
      .def_ro("work", &Droplet::work, "W [energy]")
      .def_prop_ro("energy", &Droplet::energy,
                   "F.a - W, what the surface has more than that of a sphere [energy]")
      .def_prop_ro("pressure", &Droplet::pressure, "pressure inside, 2 g/R at rest [energy/volume]")
      .def_prop_ro(
          "indentation", [](const Droplet &d) { return to_numpy(d.indentation); },
          nb::rv_policy::move, "a = dW/dF of each contact, (Z,) [length]")
      .def_prop_ro(
          "d_normal",
          [](const Droplet &d) {
            std::vector<double> rows;
            for (std::size_t c = 0; c < d.contacts; ++c)
              for (const auto *t : {&d.tx, &d.ty, &d.tz}) rows.push_back((*t)[c]);
            return to_numpy<Matrix>(rows.data(), {d.contacts, 3});
          },
          nb::rv_policy::move,
          "dW/dn of each normal, (Z, 3); only the part across it counts [energy]")
      .def_prop_ro(
          "compliance",
          [](const Droplet &d) {
            return to_numpy<Matrix>(d.compliance().data(), {d.contacts, d.contacts});
          },
          nb::rv_policy::move, "da/dF, (Z, Z); infinite for a force of 0 [length^2/energy]");

  m.def(
      "droplet", &droplet, "normals"_a, "forces"_a, "radius"_a = 1.0, "tension"_a = 1.0,
      "level"_a = "",
      R"(A droplet in three dimensions that keeps its volume, between contacts that bear these forces.

The work W(F) of docs/theory/droplets.md, as between walls, where films do not turn.

Parameters
----------
normals : array, shape (Z, 3)
    Outward directions of the contacts; their lengths do not matter.
forces : array, shape (Z,)
    F >= 0 [energy/length].
radius, tension : float
    R of the sphere [length] and g [energy/length^2].
level : str
    SIMD instructions, one of simd_levels(); by default the fastest ones of this processor.

Returns
-------
Droplet

Raises
------
ValueError
    Values that are not finite, unequal lengths, a normal of length 0, a negative force, an unknown level.

Source: D. C. Morse and T. A. Witten, Europhys. Lett. 22, 549 (1993), and docs/theory/droplets.md.)");
}
