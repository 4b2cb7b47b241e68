// SPDX-License-Identifier: BSD-3-Clause
// jink mesh: maps of convex pieces built from meshes, compared, drawn and inspected.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "toolchain/host/commands.hpp"
#include "toolchain/host/header_text.hpp"
#include "toolchain/host/mesh_text.hpp"
#include "toolchain/host/script.hpp"
#include "toolchain/sim/option_range.hpp"

namespace jink::host {
namespace {

namespace fs = std::filesystem;

struct MeshOptions {
    std::string file;
    std::string method = "decompose";
    std::string up = "z";
    std::string name;
    std::string out;
    std::string header;
    mesh::ReadOptions reading;
    mesh::Recipe recipe;
    std::vector<double> origin;  ///< latitude and longitude [degrees], altitude [m]; or nothing
    std::string figures;
    std::string python = "/usr/bin/python3";
};

constexpr const char* kBuildMesh = "mesh build";
constexpr const char* kMeasureMesh = "mesh measure";
constexpr const char* kShowMesh = "mesh show";

/// The result of `work`; ends the program with the message of an error.
template <class Work>
auto refusing(const char* command, const std::string& file, const Work& work)
{
    try {
        return work();
    } catch (const mesh::CannotBuild& error) {
        refuse(command, files::to_string({error.line, error.column, error.what(), file}));
    }
}

mesh::TriangleMesh mesh_of(const char* command, const MeshOptions& options)
{
    mesh::ReadOptions reading = options.reading;
    reading.y_up = options.up == "y";
    return refusing(command, options.file, [&] { return mesh::read_mesh(options.file, reading); });
}

std::string name_of(const char* command, const MeshOptions& options)
{
    const std::string name = options.name.empty() ? fs::path(options.file).stem().string() : options.name;
    if (!names_tables(name)) {
        refuse(command, "no C++ name can be made of " + files::in_quotes(name) +
                            "; give --name, of letters, digits, blanks, '-', '_' and '.'");
    }
    return name;
}

double excess_of_all(const std::vector<mesh::Piece>& pieces)
{
    double most = 0.0;
    for (const mesh::Piece& piece : pieces) {
        most = std::max(most, piece.excess);
    }
    return most;
}

mesh::Method method_of(const std::string& name)
{
    return name == "hull" ? mesh::Method::hull : name == "soup" ? mesh::Method::soup : mesh::Method::decompose;
}

/// Spacing of sample points on the surface: a hundredth of the mesh's size, at least a tenth of a metre.
double spacing_of(const mesh::TriangleMesh& mesh)
{
    mesh::Vec3d low = mesh.vertices[0];
    mesh::Vec3d high = low;
    for (const mesh::Vec3d& v : mesh.vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    return std::max(0.01 * (high - low).norm(), 0.1);
}

MeasuredMap measured(const std::string& name, const std::string& map_name, const mesh::TriangleMesh& mesh,
                     const mesh::Recipe& recipe, const geometry::MapOrigin& origin = {})
{
    const std::vector<mesh::Piece> pieces = mesh::pieces_of(mesh, recipe);
    MeasuredMap out{name, mesh::stored_map(map_name, pieces, origin), excess_of_all(pieces), 0.0};
    out.gap = mesh::gap_of(mesh, out.map.view(), spacing_of(mesh));
    return out;
}

geometry::MapOrigin origin_of(const MeshOptions& options)
{
    if (options.origin.empty()) {
        return {};
    }
    const double highest[] = {85.0, 180.0, 1e6};
    for (std::size_t i = 0; i < options.origin.size(); ++i) {
        if (!(std::abs(options.origin[i]) <= highest[i])) {
            refuse(kBuildMesh, "--origin: latitude within 85 degrees, longitude within 180 degrees and altitude within "
                               "1000 km are wanted");
        }
    }
    const auto scaled = [&](std::size_t i, double by) {
        return static_cast<std::int32_t>(std::lround(by * options.origin[i]));
    };
    return {true, scaled(0, 1e7), scaled(1, 1e7), scaled(2, 1e3)};
}

void build_mesh(const MeshOptions& options)
{
    check_outputs(kBuildMesh, {options.file}, {options.out, options.header});
    const mesh::TriangleMesh mesh = mesh_of(kBuildMesh, options);
    const std::string name = name_of(kBuildMesh, options);
    mesh::Recipe recipe = options.recipe;
    recipe.method = method_of(options.method);
    const geometry::MapOrigin origin = origin_of(options);
    const MeasuredMap made =
        refusing(kBuildMesh, options.file, [&] { return measured(options.method, name, mesh, recipe, origin); });
    const geometry::MeshMap map = made.map.view();
    std::fputs(summary_of(map).c_str(), stdout);
    std::printf(
        "of %zu triangles: no piece stands out of the mesh by more than %.3f m, nothing of it out of the pieces "
        "by more than %.4f m\n",
        mesh.triangles.size(), made.excess, made.gap);
    if (!options.out.empty()) {
        write_whole(kBuildMesh, options.out, files::map_file_of(map));
    }
    if (!options.header.empty()) {
        write_whole(kBuildMesh, options.header, map_header(map, fs::path(options.file).filename().string()));
    }
}

void measure_mesh(const MeshOptions& options)
{
    const mesh::TriangleMesh mesh = mesh_of(kMeasureMesh, options);
    const std::string name = name_of(kMeasureMesh, options);
    std::error_code error;
    if (!options.figures.empty() && !fs::create_directories(options.figures, error) && error) {
        refuse(kMeasureMesh, options.figures + " cannot be made: " + error.message());
    }
    std::vector<MeasuredMap> maps;
    const auto add = [&](const std::string& title, mesh::Method method, double concavity) {
        mesh::Recipe recipe = options.recipe;
        recipe.method = method;
        recipe.concavity = concavity;
        try {
            maps.push_back(measured(title, name, mesh, recipe));
        } catch (const mesh::CannotBuild& refused) {
            std::printf("%s: %s\n", title.c_str(), refused.what());
        }
    };
    add("hull", mesh::Method::hull, options.recipe.concavity);
    for (const double factor : {4.0, 1.0, 0.25}) {
        char title[32];
        std::snprintf(title, sizeof title, "decompose %.3f m", factor * options.recipe.concavity);
        add(title, mesh::Method::decompose, factor * options.recipe.concavity);
    }
    add("soup", mesh::Method::soup, options.recipe.concavity);
    if (maps.empty()) {
        refuse(kMeasureMesh, options.file + ": no method makes a map of it");
    }
    std::fputs(table_of(maps).c_str(), stdout);
    std::fflush(stdout);
    if (!options.figures.empty()) {
        become_report_script(kMeasureMesh, options.python, "mesh_maps.py", drawing_of(maps, mesh), options.figures);
    }
}

void show_mesh(const MeshOptions& options)
{
    files::Complaints complaints;
    const std::optional<files::MapTables> stored = files::read_map_file(options.file, complaints);
    if (!stored) {
        refuse(kShowMesh, files::to_string(complaints.front()));
    }
    std::fputs(summary_of(stored->view()).c_str(), stdout);
}

void add_reading(CLI::App& command, MeshOptions& options)
{
    command.add_option("mesh", options.file, "mesh file (STL or OBJ)")->required();
    command.add_option("--scale", options.reading.scale, "metres in one unit of the file")->capture_default_str();
    command.add_option("--up", options.up, "which of the file's axes is up: z, or y with z pointing backwards")
        ->capture_default_str()
        ->check(CLI::IsMember({"y", "z"}));
    command.add_option("--name", options.name, "of the map; default: the file's");
    command
        .add_option("--concavity", options.recipe.concavity, "of decompose: pieces stand out of the mesh by less [m]")
        ->capture_default_str()
        ->check(sim::positive());
    command.add_flag("--open", options.recipe.open, "take objects whose surface is not closed");
}

}  // namespace

void add_mesh(CLI::App& jink)
{
    CLI::App* command = jink.add_subcommand("mesh", "make maps of convex pieces of meshes, compare and draw them");
    command->require_subcommand(1);
    auto options = std::make_shared<MeshOptions>();
    CLI::App* build_command = command->add_subcommand("build", "make a map of a mesh");
    add_reading(*build_command, *options);
    build_command->add_option("--method", options->method, "hull of each object, decompose, or soup of triangles")
        ->capture_default_str()
        ->check(CLI::IsMember({"hull", "decompose", "soup"}));
    build_command
        ->add_option(
            "--origin", options->origin,
            "where the mesh's origin lies: LATITUDE,LONGITUDE,ALTITUDE in degrees and in metres above mean sea "
            "level; without it the map is taken in the autopilot's local frame")
        ->delimiter(',')
        ->expected(3);
    build_command->add_option("-o,--out", options->out, "write the map to this file");
    build_command->add_option("--header", options->header, "write it as constant tables to this C++ header");
    build_command->callback([options] { build_mesh(*options); });
    CLI::App* measure_command = command->add_subcommand("measure", "what each method makes of a mesh");
    add_reading(*measure_command, *options);
    measure_command->add_option("--figures", options->figures, "draw each map into this folder");
    measure_command->add_option("--python", options->python, "a Python 3 with matplotlib")->capture_default_str();
    measure_command->callback([options] { measure_mesh(*options); });
    CLI::App* show_command = command->add_subcommand("show", "what a map file holds, and whether it is good");
    show_command->add_option("map", options->file, "map file")->required();
    show_command->callback([options] { show_mesh(*options); });
}

}  // namespace jink::host
