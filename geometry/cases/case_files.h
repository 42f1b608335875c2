// Shared by the writers of solver cases. Internal.
#pragma once

#include <filesystem>
#include <string>

namespace underbody::geometry {

/// Throws core::InputError (kind "exists") when the folder is there and holds something, or is a file.
void require_empty_folder(const std::filesystem::path& folder);

/// Of an OpenFOAM file: `kind` "dictionary", "volVectorField" ...
std::string foam_header(const std::string& kind, const std::string& object);

/// constant/transportProperties of water, constant/turbulenceProperties of k-omega SST.
std::string foam_transport(double kinematic_viscosity);
std::string foam_turbulence();
void make_executable(const std::filesystem::path& file);

/// Iterations between two writes, so that a solve that was cut can go on: about an eighth of them. OpenFOAM writes its
/// last iteration only where the interval divides it; a number without a divisor in between gets no checkpoints.
int checkpoint_interval(int iterations);

/// Twelve significant digits, as every solver reads them.
std::string digits(double value);

}  // namespace underbody::geometry
