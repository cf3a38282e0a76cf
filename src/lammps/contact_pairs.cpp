#include "contact_pairs.h"

#include "contact.h"
#include "trigonometry.h"
#include "vector_loops.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

void ContactPairs::reserve(std::size_t most)
{
  if (most <= i.size()) return;
  i.resize(most);
  j.resize(most);
  for (std::vector<double> *v :
       {&dx, &dy, &radius_i, &radius_j, &per_distance, &nx, &ny, &angle, &indentation_i,
        &indentation_j, &d_indentation_i, &d_indentation_j})
    v->resize(most);
}

// The loop has no branch.
DEFORMABLE_CLONES void LAMMPS_NS::compute_contact_lines(ContactPairs &p)
{
  const int n = p.size;
  const double *const dx = p.dx.data(), *const dy = p.dy.data();
  const double *const ri = p.radius_i.data(), *const rj = p.radius_j.data();
  double *const per_distance = p.per_distance.data(), *const angle = p.angle.data();
  double *const nx = p.nx.data(), *const ny = p.ny.data();
  double *const ai = p.indentation_i.data(), *const aj = p.indentation_j.data();
  double *const d_ai = p.d_indentation_i.data(), *const d_aj = p.d_indentation_j.data();
  DEFORMABLE_INDEPENDENT
  for (int k = 0; k < n; ++k) {
    const double d = std::sqrt(dx[k] * dx[k] + dy[k] * dy[k]), per_d = 1.0 / d;
    const ContactLine line = contact_line(d, per_d, ri[k], rj[k]);
    per_distance[k] = per_d;
    nx[k] = dx[k] * per_d;
    ny[k] = dy[k] * per_d;
    angle[k] = angle_of(dx[k], dy[k]);
    ai[k] = line.indentation_i;
    aj[k] = line.indentation_j;
    d_ai[k] = line.d_indentation_i;
    d_aj[k] = line.d_indentation_j;
  }
}

/* ---------------------------------------------------------------------- */

int LAMMPS_NS::insert_pairs(const ContactPairs &pairs, int nlocal, ContactTable &table)
{
  // copies of the table's addresses, renewed only when its memory has moved
  int stride, *row, *count;
  Contact *contact;
  Partner *partner;
  const auto get_addresses = [&] {
    stride = table.stride;
    row = table.row.data();
    count = table.count.data();
    contact = table.contact.data();
    partner = table.partner.data();
  };
  const auto new_place = [&](int i) {
    if (row[i] < 0 || count[row[i]] == stride) {
      table.make_room(i);
      get_addresses();
    }
    return static_cast<std::size_t>(row[i]) * stride + count[row[i]]++;
  };
  get_addresses();

  for (int k = 0; k < pairs.size; ++k) {
    const int i = pairs.i[k], j = pairs.j[k];
    const double theta = pairs.angle[k], nx = pairs.nx[k], ny = pairs.ny[k];
    const double ai = pairs.indentation_i[k], aj = pairs.indentation_j[k];
    const double per_distance = pairs.per_distance[k];
    if (!(ai < pairs.radius_i[k] && aj < pairs.radius_j[k])) return k;

    const std::size_t at_i = new_place(i);
    contact[at_i] = {theta, nx, ny, ai};
    partner[at_i] = {j, pairs.d_indentation_i[k], per_distance};
    if (j >= nlocal) continue;
    const std::size_t at_j = new_place(j);
    contact[at_j] = {theta > 0.0 ? theta - PI : theta + PI, -nx, -ny, aj};
    partner[at_j] = {i, pairs.d_indentation_j[k], per_distance};
  }
  return -1;
}
