#include "solver/contact_batches.h"

#include <algorithm>
#include <cstdint>

namespace deformable {

void ContactBatches::arrange(const int *order, int rings, int particles, NearPairs &pairs,
                             const tagint *tags, bool has_own)
{
  count.assign(particles, 0);
  for (int k = 0; k < pairs.size; ++k) {
    ++count[pairs.i[k]];
    if (k < pairs.remote) ++count[pairs.second(k)];
  }
  // pressures are the first guesses of the next call
  std::vector<LoadedRing> last(particles);
  for (std::size_t ring = 0; ring < particle.size(); ++ring)
    if (particle[ring] >= 0 && particle[ring] < particles) last[particle[ring]] = loaded(ring);
  place_rings(order, rings, particles);
  make_room(pairs, has_own);
  for (std::size_t ring = 0; ring < particle.size(); ++ring) {
    if (particle[ring] < 0) continue;
    pressure[ring] = last[particle[ring]].pressure;
    if (soft) expansion[ring] = last[particle[ring]].expansion;
  }
  number_contacts(pairs, tags);
}

// Rings with equal numbers of contacts share a batch. They are sorted within blocks only, so that neighbors stay
// close in memory.
void ContactBatches::place_rings(const int *order, int rings, int particles)
{
  batches = (rings + LANES - 1) / LANES;
  particle.assign(batches * LANES, -1);
  std::copy_n(order, rings, particle.begin());
  for (int begin = 0; begin < rings; begin += BLOCK)
    std::stable_sort(particle.begin() + begin, particle.begin() + std::min(begin + BLOCK, rings),
                     [this](int a, int b) { return count[a] < count[b]; });

  place.assign(particles, -1);
  size.resize(batches);
  first.assign(batches + 1, 0);
  first_green.assign(batches + 1, 0);
  for (int b = 0; b < batches; ++b) {
    int most = 0;
    for (int w = 0; w < LANES; ++w) {
      const int i = particle[b * LANES + w];
      if (i < 0) continue;
      place[i] = b * LANES + w;
      most = std::max(most, count[i]);
    }
    size[b] = most;
    first[b + 1] = first[b] + most * LANES;
    first_green[b + 1] = first_green[b] + static_cast<std::size_t>(most) * (most - 1) / 2 * LANES;
  }
  contacts = first[batches];
}

void ContactBatches::make_room(const NearPairs &pairs, bool has_own)
{
  const std::size_t rings = particle.size(), two = first_green[batches];
  const int remote = pairs.wall - pairs.remote, remote_rings = pairs.curved ? remote : 0;
  pressure.assign(rings + remote_rings, 0.0);
  for (LargeVector<double> *v : {&work, &total, &per_pressure}) v->assign(rings, 0.0);
  square.assign(rings, 0.0F);
  radius.assign(rings, 1.0);
  expansion.clear();    // of rings at other places
  Members given;
  for (int m = 0; m < MEMBERS; ++m) given[m] = !stiffness[m].empty();
  set_kind(soft, !skin.empty(), given);

  if (two > green.capacity()) {    // no more than needed, and no copy
    green = {};
    green.reserve(two + two / 64);
  }
  green.resize(two);
  const std::size_t longest = size.empty() ? 0 : *std::max_element(size.begin(), size.end());
  scratch_of_thread = (7 * longest + 1) * LANES * sizeof(double);
  scratch.resize(threads * scratch_of_thread);
  pair_side.assign(contacts, 2 * pairs.size);
  for (LargeVector<double> *v : {&indentation, &slope}) v->assign(contacts + remote + 1, 0.0);
  compliance.assign(contacts + remote + 1, 0.0F);
  product.assign(2 * slope.size(), 0.0F);
  for (LargeVector<float> *v : {&share, &weight, &left, &direction, &step})
    v->assign(contacts, 0.0F);
  own.assign(has_own || pairs.curved ? contacts : 0, 0.0F);
  const std::size_t rings_of_lines = pairs.curved ? pressure.size() : 0;
  for (LargeVector<double> *v : {&free_radius_of, &bulk_and_swell, &change})
    v->assign(rings_of_lines, 0.0);
  per_lengths.assign(rings_of_lines, 0.0F);
  for (LargeVector<float> *v : {&normal[0], &normal[1]})
    v->assign(pairs.curved ? contacts : 0, 0.0F);
  for (LargeVector<float> *v : {&rate_of_slope, &across})
    v->assign(pairs.curved ? slope.size() : 0, 0.0F);
  turn.resize(pairs.curved ? two : 0);
  partner.assign(contacts, contacts + remote);
  film_tension.assign(pairs.adhesive ? rings : 0, 0.0);
  for (LargeVector<double> &v : film) v.assign(pairs.adhesive ? slope.size() : 0, 0.0);
}

void ContactBatches::number_contacts(NearPairs &pairs, const tagint *tags)
{
  const int remote = pairs.wall - pairs.remote;
  std::fill(count.begin(), count.end(), 0);
  const auto add_contact = [this](int i, int of) { pair_side[contact(place[i], count[i]++)] = of; };
  for (int k = 0; k < pairs.size; ++k) {
    add_contact(pairs.i[k], 2 * k);
    if (k < pairs.remote) add_contact(pairs.second(k), 2 * k + 1);
  }
  for (std::size_t i = 0; i < place.size(); ++i)
    if (place[i] >= 0) sort_contacts(static_cast<int>(i), pairs, tags);
  for (int c = 0; c < contacts; ++c)
    if (pair_side[c] < 2 * pairs.size) pairs.side[pair_side[c] & 1][pair_side[c] >> 1] = c;
  for (int k = 0; k < pairs.size; ++k) {
    const int first = pairs.side[0][k];
    int &second = pairs.side[1][k];
    if (k >= pairs.remote) second = contacts + (k < pairs.wall ? k - pairs.remote : remote);
    if (k < pairs.wall) partner[first] = second;
    if (k < pairs.remote) partner[second] = first;
  }
}

void ContactBatches::set_kind(bool soft_, bool skinned, const Members &given)
{
  soft = soft_;
  const std::size_t soft_rings = soft ? particle.size() : 0;
  if (expansion.size() != soft_rings) expansion.assign(soft_rings, 0.0);
  for (LargeVector<float> *v : {&mixed, &rate})
    if (v->size() != soft_rings) v->assign(soft_rings, 0.0F);
  skin.assign(skinned ? particle.size() : 0, 0.0);
  const Stiffness empty = {1.0, 1.0};    // of lanes without a particle
  for (int m = 0; m < MEMBERS; ++m) {
    const std::size_t rings = given[m] ? particle.size() : 0;
    if (stiffness[m].size() != rings) stiffness[m].assign(rings, empty.*PARAMETERS[m].of_ring);
  }
}

// By the partners' tags: then a ring adds up the same numbers in the same order on any number of ranks.
void ContactBatches::sort_contacts(int i, const NearPairs &pairs, const tagint *tags)
{
  const auto partner_of = [&](int s) -> tagint {
    const int k = s >> 1;
    return s & 1 ? tags[pairs.i[k]] : k < pairs.wall ? tags[pairs.j[k]] : pairs.j[k];
  };
  for (int m = 1; m < count[i]; ++m) {
    const int s = pair_side[contact(place[i], m)];
    const tagint tag = partner_of(s);
    int to = m;
    for (; to > 0; --to) {
      const int before = pair_side[contact(place[i], to - 1)];
      if (partner_of(before) <= tag) break;
      pair_side[contact(place[i], to)] = before;
    }
    pair_side[contact(place[i], to)] = s;
  }
}

StiffnessArrays ContactBatches::stiffnesses() const
{
  StiffnessArrays arrays = {};
  for (int m = 0; m < MEMBERS; ++m)
    if (!stiffness[m].empty()) arrays.*PARAMETERS[m].of_rings = stiffness[m].data();
  return arrays;
}

RingBatches ContactBatches::arrays(int thread)
{
  // the scratch memory of vectors begins at a multiple of their size
  constexpr std::size_t SIZE = LANES * sizeof(double);
  unsigned char *const own_scratch = scratch.data() + thread * scratch_of_thread;
  const std::size_t address = reinterpret_cast<std::uintptr_t>(own_scratch);
  void *const aligned = own_scratch + (SIZE - address % SIZE) % SIZE;
  const auto unless_empty = [](auto &v) { return v.empty() ? nullptr : v.data(); };
  RingBatches b = {};
  b.end = batches;
  b.size = size.data();
  b.first = first.data();
  b.first_green = first_green.data();
  b.soft = soft;

  RingArrays &r = b.rings;
  r.radius = radius.data();
  r.stiffness = stiffnesses();
  r.pressure = pressure.data();
  r.work = work.data();
  r.total = total.data();
  r.per_pressure = per_pressure.data();
  r.square = square.data();
  if (soft) {
    r.expansion = expansion.data();
    r.mixed = mixed.data();
    r.rate = rate.data();
  }
  r.skin = unless_empty(skin);
  r.scale = scale;

  ContactArrays &c = b.contacts;
  c.pair_side = pair_side.data();
  c.indentation = indentation.data();
  c.compliance = compliance.data();
  c.slope = slope.data();
  c.share = share.data();
  c.green = green.data();
  c.own = unless_empty(own);
  c.scratch = aligned;

  CorrectionArrays &x = b.corrections;
  x.partner = partner.data();
  x.none = none();
  x.weight = weight.data();
  x.left = left.data();
  x.direction = direction.data();
  x.step = step.data();
  x.product = x.last_product = product.data();
  x.products = none() + 1;

  b.films.tension = unless_empty(film_tension);
  for (int n = 0; n < 4; ++n) b.films.terms[n] = film[n].data();

  OutlineArrays &o = b.outline;
  o.free_radius = unless_empty(free_radius_of);
  o.bulk_and_swell = bulk_and_swell.data();
  o.per_lengths = per_lengths.data();
  o.change = change.data();
  o.nx = normal[0].data();
  o.ny = normal[1].data();
  o.rate = rate_of_slope.data();
  o.across = across.data();
  o.turn = turn.data();
  o.length = length;
  return b;
}

std::vector<RingBatches> ContactBatches::of_threads()
{
  std::vector<RingBatches> all;
  for (int thread = 0; thread < threads; ++thread) all.push_back(arrays(thread));
  return all;
}

double ContactBatches::bytes() const
{
  double all = 0.0;
  for (const LargeVector<double> &v : stiffness) all += bytes_of(v);
  return all + bytes_of(size, first, first_green, particle, radius, skin, pressure, expansion, work,
                        total, per_pressure, mixed, square, rate, pair_side, indentation,
                        compliance, slope, share, own, product, partner, weight, left, direction,
                        step, green, scratch, place, count, film_tension, film[0], film[1], film[2],
                        film[3], free_radius_of, bulk_and_swell, change, per_lengths, normal[0],
                        normal[1], rate_of_slope, across, turn);
}

}    // namespace deformable
