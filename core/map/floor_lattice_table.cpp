// SPDX-License-Identifier: Apache-2.0
#include "core/map/floor_lattice_table.h"

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "core/map/checked_row.h"

namespace floorloc {
namespace {

// Of the vectors of a lattice: readers count its places, which must not be too many.
constexpr double kMinPeriodM = 0.01;
constexpr double kMaxPeriodM = 100.0;
constexpr double kMinSine = 0.2;  // the two shortest vectors of a lattice are at least 60 degrees apart

RectM ReadExtent(const CheckedRow& row) {
  const RectM extent{row.Coordinate(1, "x_min"), row.Coordinate(2, "x_max"), row.Coordinate(3, "y_min"),
                     row.Coordinate(4, "y_max")};
  if (extent.width_m() < 0.0 || extent.height_m() < 0.0) {
    row.Refuse("x_min exceeds x_max, or y_min y_max");
  }
  return extent;
}

Eigen::Matrix2d ReadBasis(const CheckedRow& row) {
  // Read before they are put in: a comma initializer that an exception leaves half done asserts.
  const Eigen::Vector2d first(row.Real(6, "first_x", -kMaxPeriodM, kMaxPeriodM),
                              row.Real(7, "first_y", -kMaxPeriodM, kMaxPeriodM));
  const Eigen::Vector2d second(row.Real(8, "second_x", -kMaxPeriodM, kMaxPeriodM),
                               row.Real(9, "second_y", -kMaxPeriodM, kMaxPeriodM));
  Eigen::Matrix2d basis;
  basis << first, second;
  const double first_m = basis.col(0).norm();
  const double second_m = basis.col(1).norm();
  if (first_m < kMinPeriodM || second_m < kMinPeriodM) {
    row.Refuse("a vector is shorter than a centimetre");
  }
  if (std::abs(basis.determinant()) < kMinSine * first_m * second_m) {
    row.Refuse("its vectors are almost parallel");
  }
  return basis;
}

MapLattice ReadFloorLattice(const CheckedRow& row) {
  MapLattice lattice;
  lattice.extent = ReadExtent(row);
  lattice.floor_share = row.Real(5, "floor_share", 0.0, 1.0);
  lattice.basis = ReadBasis(row);
  lattice.point_m = {row.Coordinate(10, "point_x"), row.Coordinate(11, "point_y")};
  lattice.residual_m = row.Real(12, "residual_m", 0.0, kMaxPeriodM);
  lattice.share = row.Real(13, "share", 0.0, 1.0);
  return lattice;
}

}  // namespace

void WriteFloorLattices(const SqliteConnection& connection, const std::vector<MapLattice>& lattices) {
  SqliteStatement insert(connection, "INSERT INTO floor_lattice VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  for (std::size_t region = 0; region < lattices.size(); ++region) {
    const MapLattice& lattice = lattices[region];
    insert.Bind(static_cast<std::int64_t>(region));
    insert.Bind(lattice.extent.x_min).Bind(lattice.extent.x_max).Bind(lattice.extent.y_min).Bind(lattice.extent.y_max);
    insert.Bind(lattice.floor_share);
    insert.Bind(lattice.basis(0, 0)).Bind(lattice.basis(1, 0)).Bind(lattice.basis(0, 1)).Bind(lattice.basis(1, 1));
    insert.Bind(lattice.point_m.x()).Bind(lattice.point_m.y()).Bind(lattice.residual_m).Bind(lattice.share).Run();
  }
}

std::vector<MapLattice> ReadFloorLattices(const SqliteConnection& connection) {
  SqliteStatement statement(connection,
                            "SELECT region, x_min, x_max, y_min, y_max, floor_share, first_x, first_y, second_x, "
                            "second_y, point_x, point_y, residual_m, share FROM floor_lattice ORDER BY region");
  std::vector<MapLattice> lattices;
  while (statement.Step()) {
    const CheckedRow row(connection, statement, "floor_lattice " + std::to_string(lattices.size()));
    if (row.Long(0, "region") != static_cast<std::int64_t>(lattices.size())) {
      row.Refuse("the regions are not numbered from 0 without a gap");
    }
    lattices.push_back(ReadFloorLattice(row));
  }
  return lattices;
}

}  // namespace floorloc
