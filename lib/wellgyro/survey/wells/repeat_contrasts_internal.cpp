#include "wellgyro/survey/wells/repeat_contrasts_internal.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/core.h>

#include "wellgyro/math/rotation.h"
#include "wellgyro/survey/hole/listing_errors_internal.h"
#include "wellgyro/survey/hole/same_depth_internal.h"
#include "wellgyro/uncertainty/station_errors.h"

namespace wellgyro {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A survey, the errors of its stations, and where in it the hole's common depths lie.
struct Listing {
  const RepeatedSurvey* survey = nullptr;
  /// Its depths, and there the mean direction of all surveys: weights are functions of the hole,
  /// and what is the same error in two surveys must cancel whatever else they have.
  SurveyedWell hole;
  SurveyErrors errors;
  double begin = 0, end = 0;  // MD of what the model serves [m]
  double spacing = 0;         // mean, of stations [m]
  std::vector<double> depths;
  std::vector<std::size_t> place;  // of each, in the hole's
  std::vector<ListedPlace> listed;

  bool Covers(double md) const { return md >= begin - kRoundedDepth && md <= end + kRoundedDepth; }
};

/// Inclination and azimuth at each of a survey's stations, of the mean direction of all surveys
/// that reach it.
SurveyedWell MeanHole(const SurveyedWell& well, std::span<const RepeatedSurvey> surveys) {
  std::vector<Vector3d> sum(well.survey.size(), Vector3d::Zero());
  for (const RepeatedSurvey& other : surveys) {
    const auto& stations = other.well.survey;
    std::vector<double> depths;
    std::vector<std::size_t> at;
    for (std::size_t k = 0; k < well.survey.size(); ++k) {
      const double md = well.survey[k].md;
      if (md < stations.front().md || md > stations.back().md) continue;
      depths.push_back(md);
      at.push_back(k);
    }
    if (depths.empty()) continue;
    const std::vector<ListedPlace> places = PlacesIn(other.well, depths);
    for (std::size_t i = 0; i < at.size(); ++i) {
      sum[at[i]] += places[i].fraction > 0
                        ? places[i].smooth_W
                        : Tangent(stations.front().inclination, stations.front().azimuth);
    }
  }
  SurveyedWell mean = well;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Vector3d& t = sum[k];
    mean.survey[k].inclination = InclinationOf(t);
    mean.survey[k].azimuth = AzimuthOf(t);
  }
  return mean;
}

/// Nothing where the model serves less than three stations. A first station at MD 0 is a
/// convention.
std::optional<Listing> ListingOf(const RepeatedSurvey& survey, const RepeatedHole& hole,
                                 const ErrorModel& model) {
  Listing listing;
  listing.survey = &survey;
  listing.hole = MeanHole(survey.well, hole.surveys);
  const auto& stations = listing.hole.survey;
  const ToolLeg leg{&model, 0, stations.size(), survey.run};
  listing.errors = ErrorsAtStations(stations, hole.surroundings, {&leg, 1});
  if (listing.errors.stations < 3) return std::nullopt;
  const std::size_t first = stations.front().md == 0 ? 1 : 0, last = listing.errors.stations - 1;
  listing.begin = stations[first].md;
  listing.end = stations[last].md;
  listing.spacing = (listing.end - listing.begin) / static_cast<double>(last - first);
  return listing;
}

/// Stations of the surveys with the widest spacing first, of others where those do not reach, as
/// far as two surveys do.
std::vector<double> CommonDepths(const std::vector<Listing>& listings) {
  std::vector<const Listing*> order;
  for (const Listing& l : listings) order.push_back(&l);
  std::ranges::stable_sort(order, std::greater{}, [](const Listing* l) { return l->spacing; });
  std::vector<double> depths;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto before = std::span(order).first(i);
    for (const SurveyPoint& p : order[i]->survey->well.survey) {
      const auto covers = [&](const Listing* l) { return l->Covers(p.md); };
      if (!covers(order[i]) || std::ranges::any_of(before, covers)) continue;
      if (std::ranges::count_if(order, covers) > 1) depths.push_back(p.md);
    }
  }
  std::ranges::sort(depths);
  return depths;
}

/// One common depth: the surveys that reach it, and the plane across the mean of their directions.
struct CommonDepth {
  std::vector<std::size_t> listings;
  Vector3d high = Vector3d::Zero(), right = Vector3d::Zero();
  Index row = 0;

  Vector2d Of(const Vector3d& v) const { return {high.dot(v), right.dot(v)}; }
  Index rows() const { return 2 * (static_cast<Index>(listings.size()) - 1); }
};

/// Helmert's contrasts, orthonormal: the k-th has the mean of the first k listings against the
/// next.
double Weight(Index contrast, Index listing) {
  const auto k = static_cast<double>(contrast + 1);
  if (listing <= contrast) return 1 / std::sqrt(k * (k + 1));
  return listing == contrast + 1 ? -k / std::sqrt(k * (k + 1)) : 0;
}

/// Key of what is one and the same error: of one term and group, within a survey (random), a run
/// (systematic), or everywhere.
using Shared = std::tuple<std::string, int, std::int64_t>;

Shared SharedBy(const NamedSource& source, std::int64_t group, std::size_t listing, int run) {
  switch (source.propagation) {
    case Propagation::kRandom:
      return {source.term, static_cast<int>(listing), group};
    case Propagation::kSystematic:
      return {source.term, run, group};
    default:
      return {source.term, 0, group};
  }
}

/// Effects of one error on rows from `first` on.
struct Effect {
  Index first = 0;
  VectorXd rows;

  /// Widens it to [begin, end).
  void Reach(Index begin, Index end) {
    if (rows.size() > 0) {
      begin = std::min(begin, first);
      end = std::max(end, first + rows.size());
    }
    VectorXd wider = VectorXd::Zero(end - begin);
    if (rows.size() > 0) wider.segment(first - begin, rows.size()) = rows;
    first = begin;
    rows = std::move(wider);
  }
};

class Contrasts {
 public:
  Contrasts(const RepeatedHole& hole, const ErrorModel& model);
  RepeatContrasts Make(const std::vector<bool>& known, double local_sigma) &&;

 private:
  void AddPlace(double md);
  void AddDirections();
  void Gather(std::size_t listing, std::map<Shared, Effect>& effects) const;
  void AddSources(const std::vector<bool>& known);
  void AddLocal(double sigma);
  std::pair<Index, Index> RowsOf(const Listing& listing, std::size_t first, std::size_t last) const;
  void AddTo(VectorXd& rows, Index first, const CommonDepth& place, std::size_t listing,
             const Vector2d& v) const;

  const ErrorModel& model_;
  std::vector<Listing> listings_;
  std::vector<CommonDepth> places_;
  RepeatContrasts result_;
};

Contrasts::Contrasts(const RepeatedHole& hole, const ErrorModel& model) : model_(model) {
  for (const RepeatedSurvey& survey : hole.surveys) {
    std::optional<Listing> listing = ListingOf(survey, hole, model);
    if (!listing) {
      result_.notes.push_back(fmt::format(
          "{}: the model serves less than three stations of a survey of run {}: left out",
          hole.name, survey.run));
      continue;
    }
    listings_.push_back(*std::move(listing));
  }
  for (const double md : CommonDepths(listings_)) AddPlace(md);
}

void Contrasts::AddPlace(double md) {
  CommonDepth place;
  for (std::size_t i = 0; i < listings_.size(); ++i) {
    Listing& l = listings_[i];
    if (!l.Covers(md)) continue;
    place.listings.push_back(i);
    l.depths.push_back(std::clamp(md, l.begin, l.end));
    l.place.push_back(places_.size());
  }
  if (!places_.empty()) place.row = places_.back().row + places_.back().rows();
  places_.push_back(std::move(place));
}

void Contrasts::AddTo(VectorXd& rows, Index first, const CommonDepth& place, std::size_t listing,
                      const Vector2d& v) const {
  const auto at =
      static_cast<Index>(std::ranges::find(place.listings, listing) - place.listings.begin());
  for (Index k = 0; 2 * k < place.rows(); ++k) {
    rows.segment<2>(place.row - first + 2 * k) += Weight(k, at) * v;
  }
}

void Contrasts::AddDirections() {
  std::vector<Vector3d> mean(places_.size(), Vector3d::Zero());
  for (Listing& l : listings_) {
    if (!l.depths.empty()) l.listed = PlacesIn(l.survey->well, l.depths);
    for (std::size_t i = 0; i < l.place.size(); ++i) mean[l.place[i]] += l.listed[i].tangent_W;
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Vector3d t = mean[i].normalized();
    const double level = std::hypot(t.x(), t.y());
    const double c = level > 1e-12 ? t.x() / level : 1, s = level > 1e-12 ? t.y() / level : 0;
    places_[i].high = {t.z() * c, t.z() * s, -level};
    places_[i].right = {-s, c, 0};
    result_.cluster.cells.push_back(places_[i].row);
  }
  result_.cluster.y = VectorXd::Zero(places_.back().row + places_.back().rows());
  for (std::size_t l = 0; l < listings_.size(); ++l) {
    for (std::size_t i = 0; i < listings_[l].place.size(); ++i) {
      const CommonDepth& place = places_[listings_[l].place[i]];
      AddTo(result_.cluster.y, 0, place, l, place.Of(listings_[l].listed[i].tangent_W));
    }
  }
}

/// Rows [begin, end) of the places that a listing has in [first, last).
std::pair<Index, Index> Contrasts::RowsOf(const Listing& listing, std::size_t first,
                                          std::size_t last) const {
  const CommonDepth& end = places_[listing.place[last - 1]];
  return {places_[listing.place[first]].row, end.row + end.rows()};
}

void Contrasts::Gather(std::size_t l, std::map<Shared, Effect>& effects) const {
  const Listing& listing = listings_[l];
  if (listing.depths.empty()) return;
  const ListingErrors errors(listing.hole, listing.errors, listing.depths);
  const std::span<const StationError> all(listing.errors.errors);
  ListedErrors listed;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].source == all[begin].source &&
           all[end].group == all[begin].group) {
      ++end;
    }
    errors.Carry(all.subspan(begin, end - begin), listed);
    if (listed.first >= listed.last) continue;
    const NamedSource& source = listing.errors.sources[all[begin].source];
    Effect& effect = effects[SharedBy(source, all[begin].group, l, listing.survey->run)];
    const auto [first, last] = RowsOf(listing, listed.first, listed.last);
    effect.Reach(first, last);
    for (std::size_t i = listed.first; i < listed.last; ++i) {
      const CommonDepth& place = places_[listing.place[i]];
      AddTo(effect.rows, effect.first, place, l, place.Of(listed.direction_W[i]));
    }
  }
}

void Contrasts::AddSources(const std::vector<bool>& known) {
  std::map<Shared, Effect> effects;
  for (std::size_t l = 0; l < listings_.size(); ++l) Gather(l, effects);
  for (const auto& [key, effect] : effects) {
    if (effect.rows.isZero(0)) continue;
    const auto term = static_cast<std::size_t>(
        std::ranges::find(model_.terms, std::get<0>(key), &ErrorTerm::name) - model_.terms.begin());
    result_.cluster.sources.push_back(
        {known[term] ? std::nullopt : std::optional(term), effect.first, effect.rows});
  }
}

/// Independent errors of equal variance stay so in the contrasts, which are orthonormal.
void Contrasts::AddLocal(double sigma) {
  for (Index row = 0; row < result_.cluster.y.size(); ++row) {
    result_.cluster.sources.push_back({model_.terms.size(), row, VectorXd::Constant(1, sigma)});
  }
}

RepeatContrasts Contrasts::Make(const std::vector<bool>& known, double local_sigma) && {
  result_.places = places_.size();
  if (places_.empty()) return std::move(result_);
  AddDirections();
  AddSources(known);
  AddLocal(local_sigma);
  return std::move(result_);
}

}  // namespace

RepeatContrasts ContrastsOf(const RepeatedHole& hole, const ErrorModel& model,
                            const std::vector<bool>& known, double local_sigma) {
  return Contrasts(hole, model).Make(known, local_sigma);
}

}  // namespace wellgyro
