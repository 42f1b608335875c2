// The header on an emulated Cortex-M4 without an operating system evaluates like the table.
#include <gtest/gtest.h>

#include "tests/surrogates/tables/exports_support.h"

namespace underbody {
namespace {

using tables::ForceTable;

/// Vectors, start and files of the host by semihosting; points.bin in, out.bin out.
const char* const program = R"(
#include "table.h"
typedef unsigned int word;
int main(void);
void reset(void);
extern word stack_top;
__attribute__((section(".vectors"), used)) static const void* const vectors[2] = {&stack_top, (const void*)reset};
static word host(word operation, const void* block) {
    register word r0 __asm("r0") = operation;
    register const void* r1 __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}
/* What the compiler calls without a library. */
void* memcpy(void* to, const void* from, word n) { char* a = to; const char* b = from; while (n-- > 0) { *a++ = *b++; } return to; }
void* memset(void* to, int v, word n) { char* a = to; while (n-- > 0) { *a++ = (char)v; } return to; }
static word opened(const char* name, word mode, word length) { const word block[3] = {(word)name, mode, length}; return host(1, block); }
static word moved(word operation, word file, void* data, word bytes) { const word block[3] = {file, (word)data, bytes}; return host(operation, block); }
void reset(void) {
    static const word stopped[2] = {0x20026, 0};
    *(volatile word*)0xE000ED88u |= 0xFu << 20; /* the floating point unit on */
    __asm volatile("dsb\nisb");
    (void)main();
    (void)host(0x18, (const void*)stopped[0]);
    for (;;) { }
}
static double in[AXES * COUNT], out[(5 + AXES) * COUNT];
int main(void) {
    word file = opened("points.bin", 1, 10), i, k;
    (void)moved(6, file, in, sizeof(in));
    for (i = 0; i < COUNT; ++i) {
        table_real p[AXES];
        table_result r;
        double* o = out + (5 + AXES) * i;
        for (k = 0; k < AXES; ++k) { p[k] = (table_real)in[AXES * i + k]; }
        table_at(p, &r);
        o[0] = (double)r.value; o[1] = (double)r.sigma; o[2] = r.outside; o[3] = r.refused; o[4] = r.no_data;
        for (k = 0; k < AXES; ++k) { o[5 + k] = (double)r.slope[k]; }
    }
    file = opened("out.bin", 5, 7);
    (void)moved(5, file, out, sizeof(out));
    return 0;
}
)";

const char* const link_script =
    "ENTRY(reset)\nSECTIONS {\n . = 0;\n .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) }\n .data : { *(.data*) }\n "
    ".bss : { *(.bss*) *(COMMON) }\n stack_top = 0x400000;\n}\n";

std::vector<double> run_on_cortex_m4(const ForceTable& table, bool single, const std::vector<double>& points) {
    core::TemporaryFolder folder;
    tables::ExportOptions options;
    options.single_precision = single;
    export_table(table, "c", folder.path() / "table.h", options);
    core::write_file(folder.path() / "main.c", program);
    core::write_file(folder.path() / "m4.ld", link_script);
    test::write_doubles(folder.path() / "points.bin", points);
    const std::string n = std::to_string(table.axes().size());
    const std::string command =
        "cd '" + folder.path().string() +
        "' && arm-none-eabi-gcc -std=c99 -O2 -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -Wall -Wextra "
        "-Werror -ffreestanding -fno-tree-loop-distribute-patterns " +
        "-nostdlib -DAXES=" + n + "u -DCOUNT=" + std::to_string(points.size() / table.axes().size()) +
        "u -T m4.ld main.c -lgcc -o main.elf > errors.txt 2>&1 && timeout 60 qemu-system-arm -M mps2-an386 -display "
        "none -serial none -monitor none "
        "-semihosting-config enable=on,target=native -kernel main.elf > qemu.txt 2>&1";
    if (std::system(command.c_str()) != 0) {
        ADD_FAILURE() << core::read_file(folder.path() / "errors.txt");
        return {};
    }
    return test::read_doubles(folder.path() / "out.bin");
}

TEST(ExportOfC, OnACortexM4EvaluatesLikeTheTable) {
    for (const char* needed : {"arm-none-eabi-gcc", "qemu-system-arm"}) {
        if (!test::have(needed)) {
            GTEST_SKIP() << "skipped: " << needed
                         << " is not installed (gcc-arm-none-eabi, qemu-system-arm); the header was not run on a "
                            "microcontroller";
        }
    }
    for (const ForceTable& table : {test::one_axis(), test::two_axes("gap=refuse,pitch=extrapolate"),
                                    test::three_axes(), test::band(), test::sum_of_tables()}) {
        const std::size_t n = table.axes().size();
        for (const bool single : {false, true}) {
            auto points = test::random_points(table, 2000, true);
            const auto out = run_on_cortex_m4(table, single, points);
            ASSERT_EQ(out.size(), 2000 * (5 + n));
            const test::Sizes sizes(table, points);
            for (std::size_t i = 0; i < 2000; ++i) {
                const double* o = &out[(5 + n) * i];
                const double* point = &points[n * i];
                if (!single) {
                    ASSERT_NO_FATAL_FAILURE(
                        test::expect_alike(table, point, sizes, 1e-12, o[0], o + 5, o[1], o[2] != 0, o[4] != 0));
                    continue;
                }
                bool at_an_end = false;  // there the rounded end decides
                for (std::size_t k = 0; k < n; ++k) {
                    const auto& axis = table.axes()[k];
                    for (const double end : {axis.lower, axis.upper}) {
                        at_an_end = at_an_end || std::abs(point[k] - end) < 1e-6 * (axis.upper - axis.lower);
                    }
                }
                const auto e = test::expected(table, point);
                if (!at_an_end && !e.refused) {
                    ASSERT_NEAR(o[0], e.at.value, 2e-6 * sizes.value);
                    ASSERT_NEAR(o[1], e.at.sigma, 1e-6 * sizes.sigma);
                    ASSERT_EQ(o[2] != 0, e.at.outside);
                    ASSERT_EQ(o[4] != 0, e.at.no_data);
                }
            }
        }
    }
}

}  // namespace
}  // namespace underbody
