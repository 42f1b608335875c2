// The parts of study.toml as they were read: cases, bodies, tables, regions, the sweep.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cases/case_mesh.h"
#include "cases/conditions.h"
#include "cases/jet_axis.h"

namespace underbody::cases {

/// One CFD case of the study.
struct Case {
    /// File name without folder and ending, of an OpenFOAM case its folder's; where several would be called so, with as
    /// many folders before it as tell them apart. Unique in the study.
    std::string name;
    std::filesystem::path file;  ///< or the folder of an OpenFOAM case
    Conditions conditions;
    std::vector<std::string> zones;  ///< patterns of the zones that are the body; empty: all walls
    /// What the file does not say, by whoever knows: unit of its coordinates, and of variables by their name there.
    std::string length_unit;
    std::vector<std::pair<std::string, std::string>> units;
    bool mean = false;  ///< one instant of a run in time: the files that differ in their time alone count as their mean
};

/// [[body]]
struct BodySpec {
    std::string name;
    std::filesystem::path shape;  ///< SHAPE.toml
};

/// [[picture]]: views of some cases.
struct PictureSpec {
    std::string name;
    Conditions where;
    std::vector<std::string> views;  ///< as postproc::possible_views names them: "pressure-underbody", ...; empty: all
    std::optional<std::pair<double, double>>
        range;  ///< Pa, of the colours of pressure, so that pictures can be compared
};

/// [[mesh_uncertainty]]: cases that differ in their mesh only.
struct MeshSpec {
    std::string name;
    Conditions where;                                   ///< selects the group
    std::string column = "mesh";                        ///< the word that tells the meshes apart
    std::vector<std::pair<std::string, double>> cells;  ///< cells of each mesh
    std::vector<std::string> quantities;
};

/// [[table]]: a force table made of cases.
struct TableSpec {
    std::string name;
    std::string quantity;           ///< lift_force, ...
    std::vector<std::string> axes;  ///< gap, pitch, ...
    Conditions where;
    std::filesystem::path shape;    ///< loads of this shape by the surrogates of [design], not of cases; `where` holds
                                    ///< conditions that are no axis. Empty: of cases
    std::string fit = "automatic";  ///< how the table is fitted (tables::fit_kind), here, in its exports and in the
                                    ///< maps of [[region]]
    double speed_exponent =
        2;  ///< of the force in a [[region]], when all its cases have one speed: (speed / that speed)^exponent
    double relative_sigma = 0;         ///< of the value, added in squares
    std::string mesh_uncertainty;      ///< name of the [[mesh_uncertainty]] whose standard uncertainty the points carry
    std::optional<double> net_weight;  ///< N: equilibria are found for it
    double virtual_mass = 0;           ///< kg, for frequency and kick
    std::vector<std::string> exports;  ///< formats
};

/// [[region]]
struct RegionSpec {
    std::string name;
    std::filesystem::path model;
    std::vector<std::string>
        forces;  ///< names of [[table]]: added to the model as force sources with their axes, fit and speed_exponent
    std::string axes;      ///< as on the command line: "gap=1mm:100mm,heave_velocity=-0.1:0.1"
    double duration = 60;  ///< s
    int columns = 400;
    int rows = 400;
};

/// [[measurement]]
struct MeasurementSpec {
    std::string name;
    std::filesystem::path model;
    std::filesystem::path data;
    bool discover = false;  ///< close the loop, not only the residual
};

/// [[compare]]: tables over one axis, laid over each other.
struct CompareSpec {
    std::string name;
    std::vector<std::string> tables;
};

/// [[verify]]: a table of the solver's own forces, one row a case.
struct VerifySpec {
    std::string name;
    std::filesystem::path table;
    Conditions where;  ///< only cases that fit
    std::vector<std::string> quantities;
    double tolerance =
        0.01;  ///< of the force's size; a column QUANTITY_scatter of the report widens it by twice itself
};

/// [sweep.slurm]: how the site wants its jobs. Texts are Slurm's own, empty ones leave it to the site.
struct SlurmSpec {
    std::string partition;
    std::string time;    ///< "02:00:00", "1-12"
    std::string memory;  ///< "4G"
    std::string account;
    int throttle = 0;                  ///< tasks at a time; 0: as many as there is room for
    int max_array = 0;                 ///< tasks in one array; 0: ask scontrol
    int cores = 1;                     ///< of one case, by MPI
    int retries = 0;                   ///< of a case whose solver was ended or failed
    bool run_study = false;            ///< a job that runs the study when the arrays have ended
    std::vector<std::string> options;  ///< further ones, "--nice=100"
};

/// [sweep]: cases to be made by CFD, every body at every gap, pitch and speed.
struct SweepSpec {
    std::string folder;            ///< of the cases, relative to the study
    std::vector<BodySpec> bodies;  ///< those of [[body]] that are named, or all
    std::vector<double> gaps;      ///< m
    std::vector<double> pitches;   ///< rad
    std::vector<double> speeds;    ///< m/s
    JetAxis jet;                   ///< through the nozzle
    Conditions conditions;         ///< further conditions of these cases (mesh = "coarse")
    double kinematic_viscosity = 1e-6;
    CaseMesh mesh;
    SlurmSpec slurm;
};

}  // namespace underbody::cases
