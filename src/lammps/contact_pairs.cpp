#include "contact_pairs.h"

#include "contact.h"
#include "trigonometry.h"

#include <cmath>

// One more version of a loop for processors with 256-bit vectors, chosen when the plugin is loaded.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && __GNUC__ >= 12
#define DEFORMABLE_CLONES __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define DEFORMABLE_CLONES
#endif

// The arrays of a loop do not overlap.
#if defined(__clang__)
#define DEFORMABLE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define DEFORMABLE_INDEPENDENT _Pragma("GCC ivdep")
#endif

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

// A loop without a branch.
DEFORMABLE_CLONES void LAMMPS_NS::meet(ContactPairs &p)
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
