// Descriptions of files: the strict reader, its hints, templates and pages come out of one table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "core/file_format.h"
#include "core/toml.h"

namespace underbody::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const FileFormat& sample() {
    static const FileFormat format{
        "sample",
        "sample.toml",
        "an example",
        {{"", "top", {{"title", "text", "\"a\"", "none", "for people"}}},
         {"body",
          "a body",
          {{"length", "m", "\"203.2 mm\"", "", "whole length"},
           {"cut", "1", "0.75", "", "how far the base lies below the centre"},
           {"base", "ellipse | rectangle", "\"ellipse\"", "ellipse", "outline"}},
          true},
         {"force[]", "a force", {{"table", "file", "\"lift.csv\"", "", "its table"}}},
         {"force[].scale.*",
          "scales",
          {{"reference", "the unit of the condition", "\"0.5 m/s\"", "", "reference"}},
          false,
          "scale.speed = { reference = \"0.5 m/s\" }"},
         {"conditions", "held", {{"*", "the unit of the quantity", "speed = 1", "", "any"}}}}};
    return format;
}

TomlTable read(const std::string& text) { return read_toml_text(text, "sample.toml", ".", sample()); }

TEST(FileFormat, KnowsKeysByTheirPlace) {
    EXPECT_NE(sample().key("body", "length"), nullptr);
    EXPECT_EQ(sample().key("body", "table"), nullptr);
    EXPECT_NE(sample().key("force[3].scale.speed", "reference"), nullptr);
    EXPECT_EQ(sample().key("conditions", "pitch")->name, "*");
    EXPECT_THAT(sample().names(""), ElementsAre("title", "body", "force", "conditions"));
    EXPECT_THAT(sample().names("force[1]"), ElementsAre("table", "scale"));
    EXPECT_TRUE(sample().knows("force[1].scale", "speed"));
    EXPECT_FALSE(sample().knows("force[1]", "speed"));
    EXPECT_EQ(heading_of("force[2].scale.speed"), "[force.scale.speed]");
    EXPECT_EQ(heading_of("mass.point[1]"), "[[mass.point]]");
}

TEST(FileFormat, AnUnknownNameIsToldBeforeWhatIsMissing) {
    try {
        (void)read("title = \"x\"\n[body]\nlenght = 1\n[[force]]\n");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.kind(), "key");
        EXPECT_THAT(error.message(), HasSubstr("body.lenght"));
        EXPECT_THAT(error.hint(), HasSubstr("'length'"));
        EXPECT_EQ(error.place().line.value_or(0), 3);
    }
    EXPECT_THROW((void)read("[bodi]\nlength = 1\n"), InputError);
    EXPECT_THROW((void)read("[[force]]\ntable = \"a\"\nscale.speed = { refrence = 1 }\n"), InputError);
    EXPECT_NO_THROW((void)read("[conditions]\nwhatever = 1\n"));
}

TEST(FileFormat, WhatIsMissingIsToldWithALineThatCanBeCopied) {
    const TomlTable root = read("title = \"x\"\n[body]\nlength = 1\n[[force]]\n");
    try {
        (void)root.table("body").quantity("cut", "1");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.hint(), "add cut = 0.75 under [body] (how far the base lies below the centre)");
    }
    try {
        (void)root.tables("force")[0].string("table");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.hint(), "add table = \"lift.csv\" under [[force]] (its table)");
    }
    try {
        (void)read("").table("body");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.hint(), "add [body] and its keys: length = \"203.2 mm\", cut = 0.75");
    }
}

TEST(FileFormat, WhatAReaderAsksForMustBeDescribed) {
    const TomlTable root = read("[body]\nlength = 1\n");
    const TomlTable body = root.table("body");
    EXPECT_THROW((void)body.has("width"), std::logic_error);
    EXPECT_THROW((void)body.find_quantity("length", "kg"), std::logic_error);
    EXPECT_THROW((void)body.choice("base", {"ellipse", "circle"}, "ellipse"), std::logic_error);
    EXPECT_EQ(body.choice("base", {"ellipse", "rectangle"}, "ellipse"), "ellipse");
}

TEST(FileFormat, ADescribedKeyThatNobodyReadsHasNoUse) {
    const TomlTable root = read("[body]\nlength = 1\ncut = 1\n");
    EXPECT_EQ(root.table("body").quantity("length", "m"), 1);
    try {
        root.finish();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.message(), HasSubstr("'body.cut' has no use"));
    }
}

TEST(FileFormat, ATemplateShowsEveryKeyAndReadsAsItStands) {
    const std::string text = template_text(sample());
    EXPECT_THAT(text, HasSubstr("\n[body]"));
    EXPECT_THAT(text, HasSubstr("\nlength = \"203.2 mm\""));
    EXPECT_THAT(text, HasSubstr("\n# base = \"ellipse\""));
    EXPECT_THAT(text, HasSubstr("\n# [[force]]"));
    EXPECT_THAT(text, HasSubstr("\n# scale.speed = { reference"));
    EXPECT_EQ(read(text).table("body").quantity("length", "m"), 0.2032);
    EXPECT_THAT(markdown_keys(sample()),
                HasSubstr("| `base` | ellipse \\| rectangle | ellipse | outline | `\"ellipse\"` |"));
}

}  // namespace
}  // namespace underbody::core
