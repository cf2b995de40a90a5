// Which part of a round a launcher wants from this process. One command line serves all tasks of
// srun, mpirun or a job array, and each task finds its number in its environment.
#pragma once

#include <string>

#include "libcore/search/expand.hpp"

namespace hapgrid {

/// The part that the environment gives this process. Ranks start at 0, parts at 1. The first of
/// these that counts several tasks is taken, or else the first that is set:
///   OMPI_COMM_WORLD_RANK of OMPI_COMM_WORLD_SIZE, PMI_RANK of PMI_SIZE (mpirun inside a Slurm job
///   hands on the Slurm variables of its own daemon, so Slurm's come after these two),
///   SLURM_PROCID of SLURM_NTASKS,
///   SLURM_ARRAY_TASK_ID counted from _MIN to _MAX in steps of _STEP.
/// Source: the manual pages of srun, sbatch, and mpirun(1) of Open MPI 4.
/// @throw UsageError when none is set, or when one that is set makes no sense.
Part part_of_launcher();

/// `pattern`, whose last {} becomes K-of-N: those of a folder's name stay.
std::string named_by_part(std::string pattern, const Part& part);

}  // namespace hapgrid
