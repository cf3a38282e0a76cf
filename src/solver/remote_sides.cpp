#include "solver/remote_sides.h"

#include "styles/all_ranks.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>
#include <numeric>
#include <type_traits>

namespace deformable {

double RemoteSides::sum(double of_this_rank) const
{
  return comm->nprocs == 1 ? of_this_rank : sum_of_ranks(world, of_this_rank);
}

double RemoteSides::largest(double of_this_rank) const
{
  return comm->nprocs == 1 ? of_this_rank : largest_of_ranks(world, of_this_rank);
}

bool RemoteSides::all_ranks_sufficient(bool sufficient, bool &refused) const
{
  enum { SUFFICIENT, INSUFFICIENT, REFUSED };
  int here = refused ? REFUSED : sufficient ? SUFFICIENT : INSUFFICIENT;
  int worst = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &worst, 1, MPI_INT, MPI_MAX, world);
  refused = worst == REFUSED;
  return worst == SUFFICIENT;
}

void RemoteSides::to_ghosts(std::vector<double> &by_particle)
{
  const int all = atom->nlocal + atom->nghost;
  by_particle.resize(all);
  std::vector<double *> each(all);
  for (int i = 0; i < all; ++i) each[i] = &by_particle[i];
  comm->forward_comm_array(1, each.data());
}

void RemoteSides::send(const void *from, void *to, int bytes_of_place)
{
  const auto *const outgoing = static_cast<const char *>(from);
  auto *const incoming = static_cast<char *>(to);
  const std::size_t size = bytes_of_place;
  std::vector<MPI_Request> requests;
  requests.reserve(messages.size());
  for (const Message &m : messages) {
    if (m.received == 0) continue;
    MPI_Request request;
    MPI_Irecv(incoming + size * m.first_received, bytes_of_place * m.received, MPI_BYTE, m.rank, 0,
              world, &request);
    requests.push_back(request);
  }
  for (const Message &m : messages)
    if (m.sent > 0)
      MPI_Send(outgoing + size * m.first_sent, bytes_of_place * m.sent, MPI_BYTE, m.rank, 0, world);
  for (MPI_Request &request : requests)    // LAMMPS' stubs have no MPI_STATUSES_IGNORE
    MPI_Wait(&request, MPI_STATUS_IGNORE);
}

void RemoteSides::match(std::vector<Candidate> &candidates)
{
  struct Record {
    tagint tag, partner;
    Vector3 x;
    PairPast past;
    bool operator<(const Record &other) const
    {
      return tag != other.tag ? tag < other.tag : partner < other.partner;
    }
  };
  static_assert(std::is_trivially_copyable<Record>::value, "ranks send it as it is");
  constexpr double ROUNDING = 1e-12;
  const int count = static_cast<int>(candidates.size());

  // the candidates of both sides of each other rank
  std::vector<int> here(comm->nprocs), there(comm->nprocs);
  for (const Candidate &c : candidates) ++here[c.rank];
  MPI_Alltoall(here.data(), 1, MPI_INT, there.data(), 1, MPI_INT, world);
  messages.clear();
  int to_send = 0, to_receive = 0;
  std::vector<int> next(comm->nprocs);    // place of the next candidate with each rank
  for (int rank = 0; rank < comm->nprocs; ++rank) {
    next[rank] = to_send;
    if (here[rank] + there[rank] > 0)
      messages.push_back({rank, here[rank], to_send, there[rank], to_receive});
    to_send += here[rank];
    to_receive += there[rank];
  }
  std::vector<Record> of_this_rank(to_send), of_others(to_receive);
  sent_at.resize(count);
  for (int c = 0; c < count; ++c) {
    const Candidate &pair = candidates[c];
    sent_at[c] = next[pair.rank]++;
    of_this_rank[sent_at[c]] = {atom->tag[pair.i], atom->tag[pair.j], pair.x, pair.past};
  }
  send(of_this_rank.data(), of_others.data(), sizeof(Record));

  std::vector<int> order(to_receive);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return of_others[a] < of_others[b]; });
  int kept = 0;
  received_at.clear();
  for (int c = 0; c < count; ++c) {
    Candidate pair = candidates[c];
    const Record wanted = {atom->tag[pair.j], atom->tag[pair.i], {}, {}};
    double nearest = ROUNDING * dot(pair.x, pair.x);
    int found = -1;
    auto other = std::lower_bound(order.begin(), order.end(), wanted,
                                  [&](int a, const Record &b) { return of_others[a] < b; });
    for (; other != order.end() && !(wanted < of_others[*other]); ++other) {
      const Vector3 apart = of_others[*other].x + pair.x;
      if (dot(apart, apart) >= nearest) continue;
      nearest = dot(apart, apart);
      found = *other;
    }
    if (found < 0) continue;    // by rounding at the end of the list: too far to bear a force
    if (pair.past.of[FORCE].last == UNKNOWN) pair.past = of_others[found].past.from_second();
    candidates[kept] = pair;
    sent_at[kept++] = sent_at[c];
    received_at.push_back(found);
  }
  candidates.resize(kept);
  sent_at.resize(kept);

  sent.assign(static_cast<std::size_t>(MOST_BYTES) * to_send, 0);
  received.assign(static_cast<std::size_t>(MOST_BYTES) * to_receive, 0);
}

}    // namespace deformable
