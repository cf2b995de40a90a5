#!/bin/bash
# The same with all committed paths of alanine dipeptide and its conformation.
SAMPLES=all exec bash "$(dirname "$0")/../prepare.sh"
