# What Doxygen is to read of a header, line by line, for a comment behind declarations.
# `double a = 0, b = 0;  ///< [m]` as a declaration each: it gives the comment to the last alone.
: next
s|^(.*\*/)?( +)([A-Za-z0-9_:<>]+)( \w+[^,;(]*), ([^;(]*;) *///<(.*)|\1\2\3\4;  /**< @brief\6 */ \3 \5  ///<\6|
t next
# With an end: it takes a comment on the next line, of the next declaration, for more of this one.
s|///<(.*)|/**< @brief\1 */|
# A header's page looks names up in the namespace too, or no type in a function's line is a link.
s|^}  // namespace wellgyro$|&\nusing namespace wellgyro;|
