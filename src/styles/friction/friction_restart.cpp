// What fix deformable/friction takes along: into restart files, to the other particle of a contact, and from ghosts back.

#include "styles/friction/fix_deformable_friction.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <string>

using namespace LAMMPS_NS;

double FixDeformableFriction::memory_usage()
{
  return FixPartnerMemory::memory_usage() + bytes_of(values, rows);
}

/* ----------------------------------------------------------------------
   What was lost so far goes on with rank 0.
------------------------------------------------------------------------- */

std::vector<double> FixDeformableFriction::all_sums()
{
  std::vector<double> sums(OUTPUTS);
  MPI_Allreduce(output, sums.data(), OUTPUTS, MPI_DOUBLE, MPI_SUM, world);
  return sums;
}

void FixDeformableFriction::go_on_from(const std::vector<double> &sums)
{
  if (comm->me == 0) std::copy(sums.begin(), sums.end(), output);
}

/* ---------------------------------------------------------------------- */

bool FixDeformableFriction::belongs_to_partner(int i, const RememberedContact &contact) const
{
  return contact.one_side == 0.0 && contact.partner > 0.0 &&
         contact.partner < static_cast<double>(atom->tag[i]);
}

RememberedContact FixDeformableFriction::from_partner(int i, const RememberedContact &contact) const
{
  RememberedContact seen = contact;
  seen.partner = static_cast<double>(atom->tag[i]);
  seen.place = contact.place.from_partner();
  return seen;
}

/* ----------------------------------------------------------------------
   The same from a text: fix_modify ID springs none, or springs I J x y xi f_t f_d ...,
   and fix_modify ID lost E_sliding E_dashpots E_damping
------------------------------------------------------------------------- */

int FixDeformableFriction::modify_param(int narg, char **arg)
{
  constexpr int LOSSES = 3, WORDS = 7;
  const std::string word = arg[0];
  const auto number = [&](int n) { return utils::numeric(FLERR, arg[n], false, lmp); };
  if (word == "lost" && narg > LOSSES) {
    for (int n = 0; n < LOSSES; ++n) output[SLIDING + n] = comm->me == 0 ? number(1 + n) : 0.0;
    return 1 + LOSSES;
  }
  if (word != "springs" || narg < 2) return 0;
  follow();
  if (narg == 2 && std::string(arg[1]) == "none") {
    for (int i = 0; i < atom->nlocal; ++i) particles[i].rows.clear();
    return narg;
  }
  const std::string command = fmt::format("fix_modify {} springs", id);
  if ((narg - 1) % WORDS)
    error->all(FLERR, "{}: expected 'none', or {} numbers for each contact, not {} words", command,
               WORDS, narg - 1);
  std::vector<double> words, partners;
  for (int n = 1; n < narg; ++n) words.push_back(number(n));
  for (std::size_t n = 0; n < words.size(); n += WORDS)
    partners.insert(partners.end(), {words[n], words[n + 1]});
  require_partners(partners, command);
  const std::unordered_map<double, int> here = local_indices();
  for (std::size_t n = 0; n < words.size(); n += WORDS) {
    const auto found = here.find(words[n]);    // or another rank has it
    if (found != here.end()) give_spring(found->second, &words[n]);
  }
  return narg;
}

// With contact radical both particles of a pair have a spring: a row of the larger ID is one of those.
void FixDeformableFriction::give_spring(int i, const double *words)
{
  RememberedContact m = {};
  m.partner = words[1];
  m.place.x = words[2];
  m.place.y = words[3];
  m.xi = words[4];
  m.force = words[5];
  m.damping = words[6];
  m.one_side = m.partner > 0.0 && m.partner < words[0] ? 1.0 : 0.0;
  particles[i].rows.push_back(m);
  make_room(i);
}

/* ----------------------------------------------------------------------
   Stresses of particles, also of those that are ghosts here.
------------------------------------------------------------------------- */

int FixDeformableFriction::pack_reverse_comm(int n, int first, double *buffer)
{
  for (int i = first; i < first + n; ++i) buffer = std::copy_n(vatom[i], 6, buffer);
  return 6 * n;
}

void FixDeformableFriction::unpack_reverse_comm(int n, int *list, double *buffer)
{
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < 6; ++c) vatom[list[k]][c] += *buffer++;
}
