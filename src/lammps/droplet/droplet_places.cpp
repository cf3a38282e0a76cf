// The places of the contacts of all droplets.

#include "droplet_solver.h"

#include "atom.h"
#include "trigonometry.h"

#include <algorithm>

using namespace LAMMPS_NS;
using deformable::PLACES;

void DropletSolver::arrange(const DropletScene &scene, DropletList &list)
{
  pairs = &list.pairs;
  remote = &list.remote_sides;
  const DropletPairs &p = *pairs;
  droplets = scene.list->inum;
  rows.assign(atom->nlocal, -1);
  for (int row = 0; row < droplets; ++row) rows[scene.list->ilist[row]] = row;
  contacts.assign(droplets, 0);
  for (int k = 0; k < p.size; ++k) {
    ++contacts[rows[p.i[k]]];
    if (k < p.remote) ++contacts[rows[p.second(k)]];
  }
  first.resize(droplets + 1);
  matrix.resize(droplets + 1);
  first[0] = 0;
  matrix[0] = 0;
  int most = 0;
  for (int row = 0; row < droplets; ++row) {
    const int places = (contacts[row] + PLACES - 1) / PLACES * PLACES;
    first[row + 1] = first[row] + places;
    matrix[row + 1] = matrix[row] + static_cast<std::size_t>(places) * contacts[row];
    most = std::max(most, places);
  }

  const int places = first[droplets], remotes = p.wall - p.remote, none = places + remotes;
  seats.assign(places, 2 * p.size);
  for (auto &side : sides) side.assign(p.size, none);
  std::fill(contacts.begin(), contacts.end(), 0);
  const auto sit = [&](int k, int side, int i) {
    const int row = rows[i], place = first[row] + contacts[row]++;
    seats[place] = 2 * k + side;
    sides[side][k] = place;
  };
  // first those that bear a force: kernels end at the last contact of a droplet whose force changes
  for (const bool bears : {true, false})
    for (int k = 0; k < p.size; ++k) {
      if ((p.past[k] > 0.0) != bears) continue;
      sit(k, 0, p.i[k]);
      if (k < p.remote) sit(k, 1, p.second(k));
      if (k >= p.remote && k < p.wall) sides[1][k] = places + k - p.remote;
    }

  for (auto *const v : {&radius, &tension, &of_load, &of_work}) v->resize(droplets);
  for (auto *const v : {&slope_of_load, &bend}) v->resize(droplets);
  for (auto *const v :
       {&normals[0], &normals[1], &normals[2], &force, &response, &turns[0], &turns[1], &turns[2]})
    v->resize(places);
  indentations.assign(none + 1, 0.0);
  for (auto *const v : {&compliance, &product}) v->assign(none + 1, 0.0f);
  rounded.resize(places);
  green.resize(matrix[droplets]);
  d_green.resize(matrix[droplets]);
  scratch.resize(most);
  residuals.resize(p.size);
  // one more than pairs: that of empty places
  for (auto *const v : {&softness, &unit, &weight, &step, &left, &direction, &change})
    v->assign(p.size + 1, 0.0f);
  set_material(scene);
  are_new = true;
}

void DropletSolver::set_material(const DropletScene &scene)
{
  const DropletPairs &p = *pairs;
  const auto tension_of = [&](int i) {
    return scene.materials->stiffness_of(i, scene.radius[i]).tension;
  };
  for (int row = 0; row < droplets; ++row) {
    const int i = scene.list->ilist[row];
    radius[row] = scene.radius[i];
    tension[row] = tension_of(i);
  }
  constexpr double PER_TENSION = 0.25 / deformable::PI;
  for (int k = 0; k < p.size; ++k) {
    const int i = p.i[k], j = k < p.wall ? p.j[k] : i;
    const double of_i = tension_of(i), of_j = tension_of(j);
    const double soft = 1.0 / of_i + (k < p.wall ? 1.0 / of_j : 0.0);
    softness[k] = static_cast<float>(PER_TENSION * soft);
    unit[k] =
        static_cast<float>(0.5 * (1.0 / (of_i * scene.radius[i]) + 1.0 / (of_j * scene.radius[j])));
  }
}

deformable::DropletArrays DropletSolver::arrays()
{
  return {first.data(),        contacts.data(), matrix.data(),     radius.data(),
          tension.data(),      of_load.data(),  of_work.data(),    slope_of_load.data(),
          bend.data(),         seats.data(),    normals[0].data(), normals[1].data(),
          normals[2].data(),   force.data(),    rounded.data(),    response.data(),
          indentations.data(), turns[0].data(), turns[1].data(),   turns[2].data(),
          compliance.data(),   green.data(),    d_green.data(),    scratch.data()};
}

double DropletSolver::memory_usage() const
{
  return bytes_of(rows, first, contacts, matrix, radius, tension, of_load, of_work, slope_of_load,
                  bend, seats, normals[0], normals[1], normals[2], force, response, indentations,
                  turns[0], turns[1], turns[2], rounded, compliance, product, green, d_green,
                  scratch, sides[0], sides[1], residuals, softness, unit, weight, step, left,
                  direction, change);
}
