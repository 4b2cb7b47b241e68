// SPDX-License-Identifier: BSD-3-Clause
// Lines of mesh files in text form: those that are taken, and the place of those that are not.
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "tests/host/scratch.hpp"
#include "toolchain/mesh/triangle_mesh.hpp"

namespace {

using jink::mesh::CannotBuild;
using jink::mesh::TriangleMesh;

TriangleMesh read(const std::string& name, const std::string& text)
{
    const jink::test::Scratch scratch;
    return jink::mesh::read_mesh(scratch.write(name, text), {});
}

TEST(MeshLines, TakesEveryUsualFormOfALine)
{
    const std::string text = "# a remark: v O 0 0\nmtllib none.mtl\no box\ng wall\ns off\nvn 0 0 1\nvt 0 0\n\n"
                             "v 0 0 0\r\nv +4.0 -0 0e0 1\nv\t0  4. 0 0.5 0.5 0.5 \nv 0 0 1e-60\nv 0 0 4\n"
                             "usemtl steel\nf -5 -3 -4\nf 1/1 2/1 5/1\nf 1//1 5//1 3//1\nf 2/1/1 3/1/1 5/1/1\n";
    EXPECT_EQ(read("a.obj", text).triangles.size(), 4U);
    EXPECT_EQ(read("A.OBJ", text).triangles.size(), 4U);
}

TEST(MeshLines, NamesLineAndColumnOfTheFirstError)
{
    const auto place = [](const std::string& name, const std::string& text) {
        try {
            static_cast<void>(read(name, text));
        } catch (const CannotBuild& error) {
            return std::pair(error.line, error.column);
        }
        return std::pair(std::size_t{0}, std::size_t{0});
    };
    EXPECT_EQ(place("a.obj", "v 0 0 0\nv 0 4.5.6 0\n"), std::pair(std::size_t{2}, std::size_t{5}));
    EXPECT_EQ(place("a.obj", "v 0 0 0\nv 0 4\n"), std::pair(std::size_t{2}, std::size_t{6}));
    EXPECT_EQ(place("a.stl", "solid a\nfacet normal 0 0 1\nouter loop\n vertex 0 0 x\n"),
              std::pair(std::size_t{4}, std::size_t{13}));
    EXPECT_EQ(place("a.stl", "solid a\nfacet normal 0 0 1\n"), std::pair(std::size_t{2}, std::size_t{1}));
}

}  // namespace
