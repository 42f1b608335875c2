// OpenFOAM cases (tests/data/openfoam: a closed box whose lid moves, solved by pisoFoam) in every coding, against the
// solver's own forces.
#include <gmock/gmock.h>
#include <vtkCellData.h>
#include <vtkCellType.h>

#include <fstream>

#include "core/file.h"
#include "core/text.h"
#include "import_support.h"
#include "postproc/importers/reports/openfoam_forces.h"
#include "postproc/loads/loads.h"
#include "tests/support/support.h"

namespace underbody {

using postproc::read_field;
using postproc::ReadOptions;
using ::testing::HasSubstr;

namespace {

namespace fs = std::filesystem;

fs::path data(const std::string& name) { return test::data_folder() / "openfoam" / name; }

void copy_case(const fs::path& from, const fs::path& to) {
    fs::create_directories(to.parent_path());
    fs::copy(from, to, fs::copy_options::recursive);
}

void expect_near(const postproc::Vector& found, const postproc::Vector& wanted, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(found[k], wanted[k], tolerance) << k;
    }
}

}  // namespace

TEST(OpenFoam, ForcesAreThoseOfTheSolverInEveryCoding) {
    // What the function object "forces" wrote with rhoInf 998 and CofR (0.01 0.02 0.03), at time 0.005.
    const postproc::Vector pressure = {6.5012259765e-01, -3.4919910512e-05, 0};
    const postproc::Vector viscous = {-7.7722379715e-01, 2.8108892963e-06, -2.3021970998e-09};
    const postproc::Vector moment = {-8.0286963578e-07, 3.1775301365e-03, 3.1460048518e-02};
    for (const char* name : {"ascii", "binary", "packed", "decomposed"}) {
        SCOPED_TRACE(name);
        const auto field = read_field(data(name));
        EXPECT_EQ(field.format, "OpenFOAM");
        EXPECT_EQ(test::cells_of(field), 32);
        EXPECT_NEAR(test::volume_of(field), 0.1 * 0.1 * 0.01, 1e-12);
        const auto* cells = field.find("internalMesh");
        ASSERT_NE(cells, nullptr);
        EXPECT_EQ(test::count_cells(*cells->volume, VTK_HEXAHEDRON), 32);
        EXPECT_EQ(cells->volume->GetNumberOfPoints(), 75);
        const auto* lid = field.find("movingWall");
        ASSERT_NE(lid, nullptr);
        EXPECT_EQ(lid->kind, postproc::ZoneKind::wall);
        EXPECT_EQ(lid->surface->GetCellData()->GetArray("velocity")->GetComponent(3, 0),
                  1);  // fixedValue uniform (1 0 0)
        EXPECT_EQ(field.find("fixedWalls")->surface->GetCellData()->GetArray("velocity")->GetComponent(3, 0),
                  0);  // noSlip
        postproc::LoadsOptions options;
        options.zones = {"*Wall*"};
        options.reference = postproc::Vector{0.01, 0.02, 0.03};
        const auto loads = postproc::loads(field, options);
        EXPECT_EQ(loads.values_from, "faces");
        expect_near(loads.pressure.force, pressure, 1e-8);
        expect_near(loads.viscous.force, viscous, 1e-8);
        expect_near(loads.total.moment, moment, 1e-9);
    }
}

TEST(OpenFoam, PressureOverDensityIsNoPressure) {
    const auto field = read_field(data("ascii"));
    const auto* lid = field.find("movingWall");
    EXPECT_EQ(lid->find("pressure"), nullptr);
    ASSERT_NE(lid->find("kinematic_pressure"), nullptr);
    EXPECT_EQ(lid->find("kinematic_pressure")->unit, "m^2/s^2");
    ASSERT_NE(lid->find("kinematic_wall_shear"), nullptr);
    EXPECT_EQ(lid->find("wall_shear"), nullptr);
    EXPECT_EQ(field.density, 998);  // rhoInf of the function object that writes the forces
    const core::TemporaryFolder folder;
    copy_case(data("ascii"), folder.path() / "box");
    fs::remove(folder.path() / "box" / "system" / "controlDict");
    EXPECT_THROW(postproc::loads(read_field(folder.path() / "box")), core::InputError);  // no density
}

TEST(OpenFoam, ATimeIsChosenOrTheNearestIsNamed) {
    ReadOptions options;
    options.time = 0.0025;
    const auto early = read_field(data("ascii"), options);
    const auto late = read_field(data("ascii"));
    EXPECT_NE(test::range_of(*early.find("movingWall")->surface, "kinematic_pressure").high,
              test::range_of(*late.find("movingWall")->surface, "kinematic_pressure").high);
    options.time = 0.004;
    EXPECT_THAT(test::refusal(data("ascii"), options), HasSubstr("0.005"));
}

TEST(OpenFoam, ANewestTimeWithoutFieldsIsPassedOverAndTold) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const auto whole = read_field(box);
    fs::create_directories(box / "0.01" / "uniform");  // a run that was ended while it wrote
    core::write_file(box / "0.01" / "uniform" / "time", "value 0.01;\n");
    core::write_file(box / "0.01" / ".p.swp", "an editor's");
    const auto field = read_field(box);
    EXPECT_EQ(test::range_of(*field.find("movingWall")->surface, "kinematic_pressure").high,
              test::range_of(*whole.find("movingWall")->surface, "kinematic_pressure").high);
    const auto told = std::find_if(field.problems.begin(), field.problems.end(), [](const core::Problem& problem) {
        return problem.severity == core::Problem::Severity::warning &&
               problem.message.find("time 0.01 holds no field: the last time that does is read (0.005") == 0;
    });
    EXPECT_NE(told, field.problems.end());
    for (const auto& problem : whole.problems) {
        EXPECT_THAT(problem.message, testing::Not(HasSubstr("holds no field")));
    }
    // A time that is asked for is the one that is read.
    ReadOptions options;
    options.time = 0.01;
    EXPECT_EQ(read_field(box, options).find("movingWall")->find("kinematic_pressure"), nullptr);
}

TEST(OpenFoam, AFileAmongTheFieldsThatIsNoneIsPassedOverAndTold) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    core::write_file(box / "0.005" / "notes.txt", "run again with a finer mesh\n");
    const auto field = read_field(box);
    EXPECT_NE(field.find("movingWall")->find("kinematic_pressure"), nullptr);
    EXPECT_TRUE(std::any_of(field.problems.begin(), field.problems.end(), [](const core::Problem& problem) {
        return problem.message == "'notes.txt' lies among the fields and is none: passed over";
    }));
    core::write_file(box / "0.005" / "p", "");  // a field that was never written is one that is damaged
    EXPECT_THAT(test::refusal(box), HasSubstr("the file is empty"));
}

TEST(OpenFoam, ACaseIsFoundByItsFolderItsFoamFileAndItsControlDict) {
    const core::TemporaryFolder folder;
    copy_case(data("ascii"), folder.path() / "box");
    std::ofstream(folder.path() / "box" / "box.foam") << "";
    EXPECT_EQ(test::cells_of(read_field(folder.path() / "box")), 32);
    EXPECT_EQ(test::cells_of(read_field(folder.path() / "box" / "system" / "controlDict")), 32);
    // An empty file, as one makes for ParaView.
    EXPECT_EQ(test::cells_of(read_field(folder.path() / "box" / "box.foam")), 32);
}

TEST(OpenFoam, OnlyWhatIsAskedForIsKept) {
    ReadOptions options;
    options.surfaces_only = true;
    options.arrays = {"kinematic_pressure"};
    const auto field = read_field(data("binary"), options);
    EXPECT_EQ(test::cells_of(field), 0);
    ASSERT_NE(field.find("movingWall"), nullptr);
    EXPECT_EQ(field.find("movingWall")->arrays.size(), 1U);
}

TEST(OpenFoam, FilesCutAnywhereAreRefusedWithTheirPlace) {
    for (const char* coding : {"ascii", "binary", "packed"}) {
        const core::TemporaryFolder folder;
        const fs::path box = folder.path() / "box";
        copy_case(data(coding), box);
        const std::string ending = coding == std::string("packed") ? ".gz" : "";
        for (const char* file : {"constant/polyMesh/points", "constant/polyMesh/faces", "constant/polyMesh/owner",
                                 "constant/polyMesh/neighbour", "constant/polyMesh/boundary", "0.005/p", "0.005/U"}) {
            const fs::path path = fs::exists(box / (file + ending)) ? box / (file + ending) : box / file;
            const std::string whole = core::read_file(path);
            const std::size_t step = std::max<std::size_t>(1, whole.size() / 12);
            // Whole up to the last bracket: what follows is comment.
            for (std::size_t size = 1; size < whole.find_last_of(")}") && size < whole.size(); size += step) {
                std::ofstream(path, std::ios::binary) << whole.substr(0, size);
                const std::string reason = test::refusal(box);
                EXPECT_THAT(reason, HasSubstr(path.filename().string())) << coding << " " << file << " cut at " << size;
                EXPECT_THAT(reason, HasSubstr("understood so far")) << coding << " " << file << " cut at " << size;
            }
            std::ofstream(path, std::ios::binary) << whole;
        }
        EXPECT_EQ(test::cells_of(read_field(box)), 32);
    }
}

/// Puts `text` before the last occurrence of `mark`.
void insert_before_last(const fs::path& path, const std::string& mark, const std::string& text) {
    std::string whole = core::read_file(path);
    const std::size_t at = whole.rfind(mark);
    ASSERT_NE(at, std::string::npos) << path;
    std::ofstream(path, std::ios::binary) << whole.insert(at, text);
}

TEST(OpenFoam, APatchWithoutFacesOnAProcessorStatesAnEmptyListWithoutItsType) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("decomposed"), box);
    for (const char* processor : {"processor0", "processor1"}) {
        const fs::path boundary = box / processor / "constant/polyMesh/boundary";
        insert_before_last(boundary, ")\n",
                           "    sensor\n    {\n        type wall;\n        nFaces 0;\n        startFace 68;\n    }\n");
        std::string text = core::read_file(boundary);
        std::ofstream(boundary, std::ios::binary) << text.replace(text.find("\n4\n"), 3, "\n5\n");
        for (const char* field : {"p", "U"}) {
            insert_before_last(box / processor / "0.005" / field, "}\n",
                               "    sensor { type fixedValue; value nonuniform 0(); }\n");
        }
    }
    const auto field = read_field(box);
    EXPECT_EQ(test::cells_of(field), 32);
    EXPECT_EQ(field.find("movingWall")->surface->GetNumberOfCells(), 8);
    // A patch that has faces needs its values.
    const fs::path pressure = box / "processor0/0.005/p";
    std::string text = core::read_file(pressure);
    const std::string stated = "type            zeroGradient;";
    std::ofstream(pressure, std::ios::binary)
        << text.replace(text.find(stated), stated.size(), "type fixedValue; value nonuniform 0();");
    EXPECT_THAT(test::refusal(box), HasSubstr("'movingWall' has 0 values for 4 faces"));
}

/// The box with another boundary field for its pressure.
void state_boundary(const fs::path& box, const std::string& boundary) {
    std::string text = core::read_file(data("ascii") / "0.005/p");
    std::ofstream(box / "0.005/p", std::ios::binary)
        << text.substr(0, text.find("boundaryField")) << "boundaryField\n{\n"
        << boundary << "}\n";
}

double pressure_on(const postproc::Field& field, const std::string& patch) {
    return field.find(patch)->surface->GetCellData()->GetArray("kinematic_pressure")->GetComponent(3, 0);
}

TEST(OpenFoam, QuotedKeysArePatternsOfWhichTheLastCountsUnlessAPlainKeyIsThere) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const auto value = [](const std::string& key, int number) {
        return key + " { type fixedValue; value uniform " + std::to_string(number) + "; }\n";
    };
    state_boundary(box, value("\".*\"", 5) + value("\"(moving|other)Wall\"", 7));
    EXPECT_EQ(pressure_on(read_field(box), "movingWall"), 7);
    EXPECT_EQ(pressure_on(read_field(box), "fixedWalls"), 5);
    state_boundary(box, value("\"(moving|other)Wall\"", 7) + value("\".*\"", 5));
    EXPECT_EQ(pressure_on(read_field(box), "movingWall"), 5);
    state_boundary(box, value("movingWall", 3) + value("\".*\"", 5));
    EXPECT_EQ(pressure_on(read_field(box), "movingWall"), 3);
    // A pattern is for the whole name.
    state_boundary(box, value("\".*\"", 5) + value("\"moving\"", 7));
    EXPECT_EQ(pressure_on(read_field(box), "movingWall"), 5);
    state_boundary(box, value("\"(moving\"", 7));
    EXPECT_THAT(test::refusal(box), HasSubstr("'(moving' is in quotation marks, but no regular expression"));
    state_boundary(box, value('"' + std::string(20000, '(') + '"', 7));
    EXPECT_THAT(test::refusal(box), HasSubstr("a pattern of 20000 characters"));
    // Time must not grow with the expression's wickedness.
    state_boundary(box, value("\".*\"", 5) + value("\"((m*)*)*b|(((.?){40}){40}){40}\"", 7));
    EXPECT_THAT(test::refusal(box), HasSubstr("no regular expression"));
}

TEST(OpenFoam, KeysMayBeGroupsOfPatches) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const fs::path file = box / "constant/polyMesh/boundary";
    std::string text = core::read_file(file);
    const std::size_t at = text.find('{', text.find("movingWall")) + 1;
    std::ofstream(file, std::ios::binary) << text.insert(at, "\n        inGroups List<word> 2(lids moving);");
    state_boundary(box,
                   "lids { type fixedValue; value uniform 7; }\nwall { type fixedValue; value uniform 5; }\n\".*\" { "
                   "type fixedValue; value uniform 3; }\n");
    EXPECT_EQ(pressure_on(read_field(box), "fixedWalls"), 5);  // walls are a group that nobody has to name
    EXPECT_EQ(pressure_on(read_field(box), "movingWall"), 5);  // the last one
    state_boundary(box, "wall { type fixedValue; value uniform 5; }\nlids { type fixedValue; value uniform 7; }\n");
    EXPECT_EQ(pressure_on(read_field(box), "movingWall"), 7);
    state_boundary(box,
                   "wall { type fixedValue; value uniform 5; }\nmovingWall { type fixedValue; value uniform 9; }\n");
    EXPECT_EQ(pressure_on(read_field(box), "movingWall"), 9);
}

TEST(OpenFoam, ValuesThatAreGuessedAreTold) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    state_boundary(box, "movingWall { type zeroGradient; }\nfrontAndBack { type empty; }\n");
    EXPECT_THAT(test::told(read_field(box)),
                HasSubstr("patch 'fixedWalls' has no entry in 'p': its values are those of the cells beside it"));
    state_boundary(box, "movingWall { $common; }\nfixedWalls { type zeroGradient; }\nfrontAndBack { type empty; }\n");
    const std::string told = test::told(read_field(box));
    EXPECT_THAT(told, HasSubstr("patch 'movingWall' takes its entry in 'p' from another, which is not read"));
    EXPECT_THAT(told, testing::Not(HasSubstr("fixedWalls")));
    EXPECT_THAT(test::told(read_field(data("ascii"))), testing::Not(HasSubstr("cells beside")));
}

TEST(OpenFoam, ALostShareOfADecomposedCaseIsNamed) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("decomposed"), box);
    fs::rename(box / "processor1", box / "processor2");
    EXPECT_THAT(test::refusal(box), HasSubstr("there is 'processor2', but no processor1"));
    fs::remove_all(box / "processor2");
    EXPECT_THAT(test::refusal(box), HasSubstr("leads to processor1, which is not there"));
}

TEST(OpenFoam, FilesThatAFieldIncludesArePassedOver) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const fs::path pressure = box / "0.005/p";
    std::string text = core::read_file(pressure);
    text.insert(text.find("dimensions"), "#include \"initialConditions\"\n");
    const std::string begin = "boundaryField\n{\n";
    text.insert(text.find(begin) + begin.size(), "    #includeEtc \"caseDicts/setConstraintTypes\"\n");
    std::ofstream(pressure, std::ios::binary) << text;
    const auto plain = read_field(data("ascii"));
    const auto field = read_field(box);
    const char* name = "kinematic_pressure";
    EXPECT_EQ(field.find("movingWall")->surface->GetCellData()->GetArray(name)->GetComponent(3, 0),
              plain.find("movingWall")->surface->GetCellData()->GetArray(name)->GetComponent(3, 0));
}

/// The box with another pressure: `top` before its cells' values, `inner` instead of these, another boundary field.
void state_pressure(const fs::path& box, const std::string& top, const std::string& inner,
                    const std::string& boundary) {
    const std::string text = core::read_file(data("ascii") / "0.005/p");
    const std::size_t begin = text.find("dimensions");
    const std::size_t values = text.find("internalField");
    std::ofstream(box / "0.005/p", std::ios::binary)
        << text.substr(0, begin) << top << text.substr(begin, values - begin)
        << (inner.empty() ? text.substr(values, text.find("boundaryField") - values) : "internalField " + inner + ";\n")
        << "boundaryField\n{\n"
        << boundary << "}\n";
}

const postproc::Field box_with(const fs::path& box, const std::string& top, const std::string& inner,
                               const std::string& boundary) {
    state_pressure(box, top, inner, boundary);
    return read_field(box);
}

TEST(OpenFoam, MacrosStandForEntriesOfTheFileAndOfWhatItIncludes) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const std::string rest = "fixedWalls { type zeroGradient; }\nfrontAndBack { type empty; }\n";
    const auto lid = [](const std::string& entries) { return "movingWall { " + entries + " }\n"; };
    // A value, one of a dictionary, braces, a whole patch, the cells' own.
    EXPECT_EQ(
        pressure_on(box_with(box, "pLid 7;\n", "", lid("type fixedValue; value uniform $pLid;") + rest), "movingWall"),
        7);
    EXPECT_EQ(pressure_on(box_with(box, "lid { pressure 8; }\n", "",
                                   lid("type fixedValue; value uniform $lid.pressure;") + rest),
                          "movingWall"),
              8);
    EXPECT_EQ(pressure_on(box_with(box, "pLid 7;\nlid { pressure ${pLid}; }\n", "",
                                   lid("type fixedValue; value uniform $:lid.pressure;") + rest),
                          "movingWall"),
              7);
    EXPECT_EQ(pressure_on(box_with(box, "lid { type fixedValue; value uniform 9; }\n", "", lid("$lid;") + rest),
                          "movingWall"),
              9);
    EXPECT_EQ(pressure_on(box_with(box, "whole \"uniform 3\";\nplain uniform 6;\n", "$plain",
                                   lid("type calculated; value $internalField;") + rest),
                          "fixedWalls"),
              6);
    const auto same =
        box_with(box, "", "uniform 4",
                 "\"other.*\" { type fixedValue; value uniform 2; }\n" + lid("type fixedValue; value $internalField;") +
                     "fixedWalls { type fixedValue; value $..movingWall.value; }\nfrontAndBack { type empty; }\n");
    EXPECT_EQ(pressure_on(same, "movingWall"), 4);
    EXPECT_EQ(pressure_on(same, "fixedWalls"), 4);
    EXPECT_THAT(test::told(same), testing::Not(HasSubstr("cells beside")));
    const auto copied = box_with(
        box, "", "",
        "fixedWalls { type fixedValue; value uniform 5; }\n" + lid("$fixedWalls;") + "frontAndBack { type empty; }\n");
    EXPECT_EQ(pressure_on(copied, "movingWall"), 5);
    // Included: beside the field, below the case, and one that includes another; not what lies outside of the case.
    core::write_file(box / "0.005/include/lids",
                     "#include \"numbers\"\nlidDict { type fixedValue; value uniform $pLid; }\n");
    core::write_file(box / "0.005/include/numbers", "pLid 11; // Pa m^3/kg\n");
    EXPECT_EQ(pressure_on(box_with(box, "#include \"include/lids\"\n", "", lid("$lidDict;") + rest), "movingWall"), 11);
    EXPECT_EQ(pressure_on(box_with(box, "#includeIfPresent \"$FOAM_CASE/0.005/include/numbers\"\n", "uniform $pLid",
                                   lid("type zeroGradient;") + rest),
                          "movingWall"),
              11);
    core::write_file(folder.path() / "outside", "pLid 12;\n");
    EXPECT_THAT(
        test::told(box_with(box, "#include \"../../outside\"\n", "uniform $pLid", lid("type zeroGradient;") + rest)),
        HasSubstr(
            "the field 'p' is left out: '$pLid' is not defined in the file, nor in what it includes of the case"));
}

TEST(OpenFoam, AFieldThatOnlyOpenFoamCanComputeIsLeftOutAndTheCaseIsRead) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const std::string boundary = "\".*\" { type zeroGradient; }\n";
    for (const std::string inner : {"uniform $nowhere", "#codeStream { code #{ os << \"} ); \" ; } #}; }",
                                    "uniform #calc \"1 + 2\"", "$nowhere", "uniform ${nowhere.at.all}"}) {
        SCOPED_TRACE(inner);
        const auto field = box_with(box, "", inner, boundary);
        EXPECT_EQ(field.find("movingWall")->find("kinematic_pressure"), nullptr);
        EXPECT_NE(field.find("movingWall")->find("velocity"), nullptr);
        EXPECT_THAT(test::told(field), HasSubstr("the field 'p' is left out: "));
    }
    // What nobody asks for may be anything; what is without end is no trap.
    const auto code =
        box_with(box, "other #calc \"2*$x\";\nmore #codeStream { code #{ } } ( #}; };\n", "uniform 3", boundary);
    EXPECT_EQ(pressure_on(code, "movingWall"), 3);
    EXPECT_THAT(test::told(box_with(box, "a $b;\nb $a;\n", "uniform $b", boundary)),
                HasSubstr("the field 'p' is left out"));
    fs::create_directories(box / "0.005/include");  // in a folder of its own: files of a time are fields
    core::write_file(box / "0.005/include/round", "#include \"round\"\n");
    EXPECT_THAT(test::told(box_with(box, "#include \"include/round\"\n", "uniform 3", boundary)),
                HasSubstr("refer to one another without end"));
    // Of two branches nobody here knows which one counts: not the last, in silence.
    for (const std::string lid : {"movingWall {\ntype fixedValue;\n#ifeq 1 1\nvalue uniform 3;\n#else\nvalue uniform "
                                  "9;\n#endif\n}\n",
                                  "#if 0\nmovingWall { type fixedValue; value uniform 9; }\n#endif\n"}) {
        const auto branches = box_with(box, "", "uniform 3", lid + boundary);
        EXPECT_EQ(branches.find("movingWall")->find("kinematic_pressure"), nullptr);
        EXPECT_THAT(test::told(branches), HasSubstr("the field 'p' is left out: '#if"));
    }
    // A patch whose value cannot be known has that of its cells, and this is said.
    const auto guessed = box_with(box, "", "uniform 3",
                                  "movingWall { type fixedValue; value uniform $nowhere; }\nfixedWalls { type "
                                  "fixedValue; value #calc \"1\"; }\nfrontAndBack { type empty; }\n");
    EXPECT_EQ(pressure_on(guessed, "movingWall"), 3);
    EXPECT_THAT(test::told(guessed),
                HasSubstr("patch 'movingWall' takes its entry in 'p' from another, which is not read"));
    EXPECT_THAT(test::told(guessed), HasSubstr("patch 'fixedWalls' takes its entry"));
}

TEST(OpenFoam, SymmetricTensorsAreInTheOrderOfVtk) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    std::string text = core::read_file(data("ascii") / "0.005/p");
    text.replace(text.find("volScalarField"), 14, "volSymmTensorField");
    std::ofstream(box / "0.005/R", std::ios::binary)
        << text.substr(0, text.find("internalField"))
        << "internalField uniform (11 12 13 22 23 33);\nboundaryField { \".*\" { type zeroGradient; } }\n";
    const auto field = read_field(box);
    for (auto* array : {field.find("internalMesh")->volume->GetCellData()->GetArray("R"),
                        field.find("movingWall")->surface->GetCellData()->GetArray("R")}) {
        ASSERT_NE(array, nullptr);
        const double wanted[] = {11, 22, 33, 12, 23, 13};
        for (int k = 0; k < 6; ++k) {
            EXPECT_EQ(array->GetComponent(0, k), wanted[k]) << k;
        }
        EXPECT_STREQ(array->GetComponentName(4), "YZ");
    }
}

TEST(OpenFoam, DimensionsMayHaveNames) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const auto state = [&](const std::string& dimensions) {
        std::string text = core::read_file(data("ascii") / "0.005/p");
        const std::size_t at = text.find('[');
        std::ofstream(box / "0.005/p", std::ios::binary) << text.replace(at, text.find(']') + 1 - at, dimensions);
    };
    state("[kinematicPressure]");
    EXPECT_NE(read_field(box).find("movingWall")->find("kinematic_pressure"), nullptr);
    state("[pressure]");
    EXPECT_NE(read_field(box).find("movingWall")->find("pressure"), nullptr);
    state("[blubber]");
    EXPECT_THAT(test::refusal(box), HasSubstr("'blubber' are not known"));
}

TEST(OpenFoam, ForcesOfARunThatBeganAgainReplaceThoseOfTheFirst) {
    const core::TemporaryFolder folder;
    const fs::path start = folder.path() / "postProcessing/forces/0";
    const auto write = [&](const std::string& name, double scale) {
        std::string text =
            "# Force\n# CofR : (0 0 0)\n#\n# Time total_x total_y total_z pressure_x pressure_y pressure_z viscous_x "
            "viscous_y viscous_z\n";
        for (int time = 1; time <= 3; ++time) {
            const std::string force = core::format_number(scale * time);
            text += std::to_string(time) + " " + force + " 0 0 " + force + " 0 0 0 0 0\n";
        }
        core::write_file(start / name, text);
    };
    for (const std::string what : {"force", "moment"}) {
        write(what + ".dat", 1);
        write(what + "_0.dat", 10);  // as OpenFOAM names the second file of one start
    }
    const auto histories = postproc::read_openfoam_forces(folder.path());
    ASSERT_EQ(histories.size(), 1U);
    EXPECT_THAT(histories[0].time, testing::ElementsAre(1, 2, 3));
    EXPECT_EQ(histories[0].pressure_force.back()[0], 30);
    EXPECT_EQ(histories[0].pressure_moment.front()[0], 10);
    EXPECT_EQ(histories[0].files.size(), 4U);
}

TEST(OpenFoam, WrongCountsAndLabelsAreRefused) {
    const core::TemporaryFolder folder;
    const fs::path box = folder.path() / "box";
    copy_case(data("ascii"), box);
    const auto reason = [&](const std::string& file, const std::string& what, const std::string& by) {
        const std::string whole = core::read_file(box / file);
        std::string text = whole;
        const std::size_t at = text.find(what);
        EXPECT_NE(at, std::string::npos) << what;
        std::ofstream(box / file, std::ios::binary) << text.replace(at, what.size(), by);
        std::string found = test::refusal(box);
        std::ofstream(box / file, std::ios::binary) << whole;
        return found;
    };
    EXPECT_THAT(reason("constant/polyMesh/owner", "128\n(\n0\n", "128\n(\n-1\n"), HasSubstr("whole number"));
    EXPECT_THAT(reason("constant/polyMesh/owner", "128\n(\n0\n", "128\n(\n999999\n"), HasSubstr("names cell 999999"));
    EXPECT_THAT(reason("constant/polyMesh/owner", "128\n(", "900000000\n("), HasSubstr("bytes are left"));
    EXPECT_THAT(reason("constant/polyMesh/faces", "4(1 6 31 26)", "4(1 6 31 2600)"), HasSubstr("names node"));
    EXPECT_THAT(reason("constant/polyMesh/faces", "4(1 6 31 26)", "900000000(1 6 31 26)"), HasSubstr("bytes are left"));
    EXPECT_THAT(reason("constant/polyMesh/boundary", "nFaces          8;", "nFaces          9;"),
                HasSubstr("should begin at"));
    EXPECT_THAT(reason("constant/polyMesh/points", "(0 0 0)", "(0 nan 0)"), HasSubstr("not a number"));
    EXPECT_THAT(reason("constant/polyMesh/points", "(0 0 0)", "(0,1 0 0)"), HasSubstr("points"));
    EXPECT_THAT(reason("0.005/p", "nonuniform List<scalar> \n32\n", "nonuniform List<scalar> \n900000000\n"),
                HasSubstr("bytes are left"));
    EXPECT_THAT(reason("0.005/p", "nonuniform List<scalar> \n32\n(", "nonuniform List<scalar> \n900000000{1}\n;("),
                HasSubstr("repeated"));
    EXPECT_THAT(reason("0.005/U", "internalField   nonuniform", "internalField   mysterious"),
                HasSubstr("'mysterious'"));
}

}  // namespace underbody
