#include "solver/films.h"

#include <algorithm>

namespace deformable {

void Films::arrange(ContactBatches &b, NearPairs &p, RemoteSides &r)
{
  pairs = &p;
  batches = &b;
  remote = &r;
  has_let_go.assign(p.size, 0);
  agree();
  for (int k = 0; k < p.size; ++k) p.least[k] = least_until_known(k);
}

// Where new circles just touch, the rounding of a ghost's position decides. Both ranks of a pair must decide alike.
void Films::agree()
{
  NearPairs &p = *pairs;
  std::vector<double> bits(batches->slope.size(), 0.0);
  const int *const side = p.side[0].data();
  for (int k = p.remote; k < p.wall; ++k) bits[side[k]] = p.attached[k];
  remote->exchange(bits.data());
  for (int k = p.remote; k < p.wall; ++k)
    p.attached[k] = p.attached[k] || bits[batches->contacts + k - p.remote] != 0.0;
}

void Films::begin_call()
{
  std::fill(has_let_go.begin(), has_let_go.end(), 0);
}

bool Films::would_change(int k, bool may_attach) const
{
  const NearPairs &p = *pairs;
  const bool bears = p.force[k] > p.least[k];
  return p.adhesion_if_attached[k] > 0.0 && bears != (p.attached[k] != 0) &&
         !(bears && (has_let_go[k] || !may_attach));
}

bool Films::would_change(bool may_attach) const
{
  bool any = false;
  for (int k = 0; k < pairs->size && !any; ++k) any = would_change(k, may_attach);
  return remote->largest(any ? 1.0 : 0.0) > 0.0;
}

void Films::change(bool may_attach)
{
  NearPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    if (!would_change(k, may_attach)) continue;
    has_let_go[k] = p.attached[k];
    p.attached[k] = !p.attached[k];
    p.least[k] = least_until_known(k);
  }
}

int Films::pressed_without_film() const
{
  for (int k = 0; k < pairs->size; ++k)
    if (has_let_go[k] && pairs->force[k] > 0.0) return pairs->i[k];
  return -1;
}

}    // namespace deformable
