#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "wellgyro/base/result.h"
#include "wellgyro/io/signature.h"
#include "wellgyro/io/toml/job_file.h"
#include "wellgyro/page/live_feed.h"

#include "page_server.h"

namespace wellgyro::apps {

struct SurveyPageOptions {
  std::string address;     ///< as PageAddressOf
  std::string token_file;  ///< keeps the token; empty: a new one each time
  std::string key;         ///< private key that signs the page's orders; empty: it sends none
  double sigma_deg = 0;    ///< of an azimuth, that stops are to have; 0: not asked
  std::string plan;        ///< a survey file with the path as planned; empty: none
};

/// The live page of a survey: hands on what the survey says, and what stands in its folder, to a
/// PageServer. What the survey calls copies a record and returns; the rest is done in threads of
/// the page's own, so that nothing that readers do reaches the survey.
class SurveyPage {
 public:
  /// Serves from here on. `job` must outlive the page. Faults of the options.
  static Result<std::unique_ptr<SurveyPage>> Open(const SurveyPageOptions& options,
                                                  const JobFile& job, const std::string& url,
                                                  const std::filesystem::path& folder);
  /// Ends as PageServer does.
  ~SurveyPage();
  SurveyPage(const SurveyPage&) = delete;
  SurveyPage& operator=(const SurveyPage&) = delete;

  /// Where it is, with the token where it wants one.
  std::string Address() const;

  // What the survey says: from any of its threads, one at a time.
  void Put(const Station& station);
  void Put(const Glance& glance);
  void Put(const Status& status);
  void Put(const Advice& advice);
  void Say(std::string_view sentence);
  /// The last words; the files are whole then.
  void End(std::string_view how, std::string_view verdict);

 private:
  struct Inbox {
    std::vector<Station> stations;
    std::optional<Glance> glance;
    std::optional<Status> status;
    std::optional<Advice> advice;
    std::deque<std::pair<std::int64_t, std::string>> notices;  ///< by UTC [us]
  };

  SurveyPage(const JobFile& job, std::string url, std::filesystem::path folder);
  std::optional<Fault> ReadKey(const std::string& path);
  template <class Change>
  void PutIn(Change change);
  void Publish();
  void Watch();
  void Post(Inbox inbox);
  void Look();
  bool Sleep(std::int64_t us);
  std::string Order(const OrderField& field);

  const JobFile& job_;
  const std::string url_;  ///< of the bus
  const std::filesystem::path folder_;
  PageAddress address_;
  std::string token_;
  std::optional<PrivateKey> key_;
  LiveFeed feed_;
  std::mutex order_mutex_;  ///< one order at a time
  std::mutex mutex_;        ///< of the inbox and `ending_`
  std::condition_variable woken_;
  Inbox inbox_;
  bool ending_ = false;
  std::map<std::filesystem::path, std::filesystem::file_time_type> seen_;  ///< run.toml, when read
  std::unique_ptr<PageServer> server_;
  std::thread publisher_, watcher_;
};

}  // namespace wellgyro::apps
