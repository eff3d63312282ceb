#pragma once

#include <functional>
#include <memory>
#include <string>

#include "wellgyro/base/result.h"
#include "wellgyro/page/live_feed.h"

#include "page_address.h"

namespace wellgyro::apps {

/// A field of the page's form for orders, empty where it was not filled in.
using OrderField = std::function<std::string(const char* name)>;

/// What a page server gives away.
struct PageService {
  std::string html;   ///< the page
  std::string token;  ///< who has it may see the page; empty: everybody who reaches it
  /// The answer to an order, as a sentence; empty: it takes none.
  std::function<std::string(const OrderField&)> order;
};

/// Serves the live page: / the page, /events what happens (LiveFeed), /order the orders. It runs in
/// threads of its own and of lower priority, as many as readers are there, kReaders at most; who
/// does not read what is sent for two seconds is let go.
class PageServer {
 public:
  static constexpr int kReaders = 128;  ///< of events, at once
  static constexpr int kOthers = 16;    ///< requests at once beside them

  /// Listens from here on. `feed` must outlive the server. Fault kIo where the address is taken.
  static Result<std::unique_ptr<PageServer>> Open(const PageAddress& address, PageService service,
                                                  LiveFeed& feed);
  /// Closes the feed, waits two seconds at most until readers have what is in it, and ends.
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  int port() const;
  int readers() const;

 private:
  struct Core;
  explicit PageServer(std::unique_ptr<Core> core);
  std::unique_ptr<Core> core_;
};

}  // namespace wellgyro::apps
