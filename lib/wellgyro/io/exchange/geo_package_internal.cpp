// A path as an OGC GeoPackage 1.3: an SQLite database with the layers path, stations and ellipses.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string_view>

#include <fmt/core.h>
#include <sqlite3.h>

#include "wellgyro/base/angle.h"
#include "wellgyro/io/exchange/geo_path_internal.h"
#include "wellgyro/io/exchange/witsml_text_internal.h"

namespace wellgyro {
namespace {

constexpr std::string_view kTables =
    "PRAGMA application_id=1196444487; PRAGMA user_version=10300;"  // "GPKG"
    "CREATE TABLE gpkg_spatial_ref_sys(srs_name TEXT NOT NULL,srs_id INTEGER PRIMARY KEY,"
    "organization TEXT NOT NULL,organization_coordsys_id INTEGER NOT NULL,definition TEXT NOT NULL,"
    "description TEXT);"
    "CREATE TABLE gpkg_contents(table_name TEXT NOT NULL PRIMARY KEY,data_type TEXT NOT NULL,"
    "identifier TEXT UNIQUE,description TEXT DEFAULT '',last_change DATETIME NOT NULL,min_x DOUBLE,"
    "min_y DOUBLE,max_x DOUBLE,max_y DOUBLE,srs_id INTEGER);"
    "CREATE TABLE gpkg_geometry_columns(table_name TEXT NOT NULL,column_name TEXT NOT NULL,"
    "geometry_type_name TEXT NOT NULL,srs_id INTEGER NOT NULL,z TINYINT NOT NULL,m TINYINT NOT "
    "NULL,"
    "PRIMARY KEY(table_name,column_name));"
    "INSERT INTO gpkg_spatial_ref_sys VALUES('Undefined cartesian SRS',-1,'NONE',-1,'undefined',"
    "NULL),('Undefined geographic SRS',0,'NONE',0,'undefined',NULL),('WGS 84 geodetic',4326,'EPSG',"
    "4326,'GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
    "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]]',NULL);"
    "CREATE TABLE path(fid INTEGER PRIMARY KEY,geom LINESTRING,well TEXT,survey TEXT,facts TEXT);"
    "CREATE TABLE stations(fid INTEGER PRIMARY KEY,geom POINT,md_m DOUBLE,inclination_deg DOUBLE,"
    "azimuth_deg DOUBLE,tvd_m DOUBLE,north_m DOUBLE,east_m DOUBLE,quality TEXT);"
    "CREATE TABLE ellipses(fid INTEGER PRIMARY KEY,geom POLYGON,md_m DOUBLE,confidence DOUBLE);"
    "INSERT INTO gpkg_geometry_columns VALUES('path','geom','LINESTRING',4326,2,0),"
    "('stations','geom','POINT',4326,2,0),('ellipses','geom','POLYGON',4326,0,0);";

class Database {
 public:
  Database() {
    sqlite3* opened = nullptr;
    const int code = sqlite3_open(":memory:", &opened);
    database_.reset(opened);
    Check(code);
  }

  void Run(std::string_view statements) {
    Check(
        sqlite3_exec(database_.get(), std::string(statements).c_str(), nullptr, nullptr, nullptr));
  }

  sqlite3* get() const { return database_.get(); }

  void Check(int code) const {
    if (code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW) return;
    throw std::runtime_error(fmt::format("SQLite: {}", sqlite3_errmsg(database_.get())));
  }

  std::string Bytes() const {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> bytes(
        sqlite3_serialize(database_.get(), "main", &size, 0), sqlite3_free);
    if (!bytes) throw std::runtime_error("SQLite gives no bytes");
    return {reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size)};
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };
  std::unique_ptr<sqlite3, Close> database_;
};

// An INSERT that is run again and again.
class Insert {
 public:
  Insert(Database& database, std::string_view statement) : database_(database) {
    sqlite3_stmt* prepared = nullptr;
    database.Check(sqlite3_prepare_v2(database.get(), statement.data(),
                                      static_cast<int>(statement.size()), &prepared, nullptr));
    statement_.reset(prepared);
  }

  Insert& Text(std::string_view text) {
    return Bound(sqlite3_bind_text(statement_.get(), ++at_, text.data(),
                                   static_cast<int>(text.size()), SQLITE_TRANSIENT));
  }
  Insert& Blob(const std::string& bytes) {
    return Bound(sqlite3_bind_blob(statement_.get(), ++at_, bytes.data(),
                                   static_cast<int>(bytes.size()), SQLITE_TRANSIENT));
  }
  Insert& Number(const std::optional<double>& value) {
    ++at_;
    return Bound(value ? sqlite3_bind_double(statement_.get(), at_, *value)
                       : sqlite3_bind_null(statement_.get(), at_));
  }

  void Run() {
    database_.Check(sqlite3_step(statement_.get()));
    sqlite3_reset(statement_.get());
    sqlite3_clear_bindings(statement_.get());
    at_ = 0;
  }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Insert& Bound(int code) {
    database_.Check(code);
    return *this;
  }

  Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  int at_ = 0;
};

// A geometry as GeoPackage has it: its own head, then well-known binary, both little-endian.
class Geometry {
 public:
  explicit Geometry(std::uint32_t type) : bytes_{'G', 'P', '\0', '\x01'} {
    Whole(4326);
    bytes_ += '\x01';
    Whole(type);
  }

  Geometry& Whole(std::uint32_t number) {
    for (int k = 0; k < 4; ++k) bytes_ += static_cast<char>((number >> (8 * k)) & 0xFF);
    return *this;
  }
  Geometry& Real(double number) {
    const auto bits = std::bit_cast<std::uint64_t>(number);
    for (int k = 0; k < 8; ++k) bytes_ += static_cast<char>((bits >> (8 * k)) & 0xFF);
    return *this;
  }
  Geometry& Place(const GeoStation& s, bool with_elevation) {
    Real(s.longitude_deg).Real(s.latitude_deg);
    if (with_elevation) Real(*s.elevation);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

constexpr std::uint32_t kPoint = 1, kLine = 2, kPolygon = 3, kWithZ = 1000;

void AddStations(Database& database, const SurveyTable& table,
                 const std::vector<GeoStation>& path) {
  Insert station(database,
                 "INSERT INTO stations(geom,md_m,inclination_deg,azimuth_deg,tvd_m,north_m,east_m,"
                 "quality) VALUES(?,?,?,?,?,?,?,?)");
  Insert ellipse(database, "INSERT INTO ellipses(geom,md_m,confidence) VALUES(?,?,?)");
  for (const GeoStation& s : path) {
    const bool z = s.elevation.has_value();
    station.Blob(Geometry(kPoint + (z ? kWithZ : 0)).Place(s, z).bytes())
        .Number(table.md(s.row))
        .Number(ToDegrees(table.inclination(s.row)))
        .Number(ToDegrees(table.azimuth(s.row)))
        .Number(table.Get(Column::kTvd, s.row))
        .Number(table.Get(Column::kNorth, s.row))
        .Number(table.Get(Column::kEast, s.row))
        .Text(table.Get(TextColumn::kQuality, s.row))
        .Run();
    if (s.ellipse.empty()) continue;
    Geometry ring(kPolygon);
    ring.Whole(1).Whole(static_cast<std::uint32_t>(s.ellipse.size()));
    for (const auto& [longitude, latitude] : s.ellipse) ring.Real(longitude).Real(latitude);
    ellipse.Blob(ring.bytes()).Number(table.md(s.row)).Number(kConfidence).Run();
  }
}

void AddPath(Database& database, const SurveyTable& table, const std::vector<GeoStation>& path) {
  bool z = true;
  for (const GeoStation& s : path) z = z && s.elevation;
  Geometry line(kLine + (z ? kWithZ : 0));
  line.Whole(static_cast<std::uint32_t>(path.size()));
  for (const GeoStation& s : path) line.Place(s, z);
  std::string facts;
  for (const auto& [key, value] : GeoFactsOf(table)) facts += key + ": " + value + "\n";
  Insert insert(database, "INSERT INTO path(geom,well,survey,facts) VALUES(?,?,?,?)");
  insert.Blob(line.bytes())
      .Text(table.head.names.well)
      .Text(table.head.names.survey)
      .Text(facts)
      .Run();
}

void AddContents(Database& database, const SurveyTable& table,
                 const std::vector<GeoStation>& path) {
  std::array<double, 4> box{180, 90, -180, -90};
  const auto widen = [&](double longitude, double latitude) {
    box = {std::min(box[0], longitude), std::min(box[1], latitude), std::max(box[2], longitude),
           std::max(box[3], latitude)};
  };
  for (const GeoStation& s : path) {
    widen(s.longitude_deg, s.latitude_deg);
    for (const auto& [longitude, latitude] : s.ellipse) widen(longitude, latitude);
  }
  const std::string created = witsml::DateTime(table.head.names.created);
  Insert insert(database, "INSERT INTO gpkg_contents VALUES(?,'features',?,'',?,?,?,?,?,4326)");
  for (const std::string_view layer : {"path", "stations", "ellipses"}) {
    insert.Text(layer).Text(layer).Text(created.empty() ? witsml::kNoDate : created);
    for (const double edge : box) insert.Number(edge);
    insert.Run();
  }
}

}  // namespace

std::string WriteGeoPackage(const SurveyTable& table) {
  const std::vector<GeoStation> path = GeoPathOf(table);
  Database database;
  database.Run(kTables);
  database.Run("BEGIN");
  AddPath(database, table, path);
  AddStations(database, table, path);
  AddContents(database, table, path);
  database.Run("COMMIT");
  return database.Bytes();
}

}  // namespace wellgyro
