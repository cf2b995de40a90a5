#!/bin/bash
# An element of a job array: hapgrid rounds my.toml -- sbatch --wait --array=1-8 element.sh
#SBATCH --output=element.%a.out --open-mode=append
exec "$@"
