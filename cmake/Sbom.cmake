# Writes OUT, a bill of materials in SPDX 2.3, for motiongan of VERSION and LICENCE: what is COMPILED_IN
# (entries name|version|licence), and which shared libraries the BINARIES load, with their Debian packages
# where dpkg knows them in the folders of LIBRARY_ARCHITECTURE. READELF lists the libraries.
cmake_minimum_required(VERSION 3.22)
set(document "{\"spdxVersion\": \"SPDX-2.3\", \"dataLicense\": \"CC0-1.0\", \"SPDXID\": \"SPDXRef-DOCUMENT\",
  \"creationInfo\": {\"creators\": [\"Tool: motiongan-${VERSION}-cmake\"]},
  \"packages\": [], \"relationships\": [{\"spdxElementId\": \"SPDXRef-DOCUMENT\",
    \"relationshipType\": \"DESCRIBES\", \"relatedSpdxElement\": \"SPDXRef-Package-motiongan\"}]}")
set(packages 0)
set(relations 1)

# text(<variable> <string>): the string as JSON.
function(text variable string)
  string(REPLACE "\\" "\\\\" string "${string}")
  string(REPLACE "\"" "\\\"" string "${string}")
  set(${variable} "\"${string}\"" PARENT_SCOPE)
endfunction()

# id_of(<variable> <name>): the SPDX id of a package.
function(id_of variable name)
  string(REGEX REPLACE "[^A-Za-z0-9.-]" "-" name "${name}")
  set(${variable} "SPDXRef-Package-${name}" PARENT_SCOPE)
endfunction()

# add_package(<name> <version> <licence> [<purl>]): once for each name.
function(add_package name version licence)
  if(name IN_LIST known)
    return()
  endif()
  set(known ${known} "${name}" PARENT_SCOPE)
  set(package "{\"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false, \"copyrightText\": \"NOASSERTION\"}")
  id_of(id "${name}")
  foreach(field "SPDXID|${id}" "name|${name}" "versionInfo|${version}"
      "licenseConcluded|${licence}" "licenseDeclared|${licence}")
    string(REGEX MATCH "^([^|]+)\\|(.*)$" field "${field}")
    set(key "${CMAKE_MATCH_1}")
    text(value "${CMAKE_MATCH_2}")
    string(JSON package SET "${package}" "${key}" "${value}")
  endforeach()
  if(ARGC GREATER 3)
    text(purl "${ARGV3}")
    string(JSON package SET "${package}" externalRefs "[{\"referenceCategory\": \"PACKAGE-MANAGER\",
      \"referenceType\": \"purl\", \"referenceLocator\": ${purl}}]")
  endif()
  string(JSON document SET "${document}" packages ${packages} "${package}")
  math(EXPR packages "${packages} + 1")
  set(packages ${packages} PARENT_SCOPE)
  set(document "${document}" PARENT_SCOPE)
endfunction()

# relate(<kind> <name>): how motiongan is related to another package.
function(relate kind name)
  id_of(id "${name}")
  string(JSON document SET "${document}" relationships ${relations}
    "{\"spdxElementId\": \"SPDXRef-Package-motiongan\", \"relationshipType\": \"${kind}\",
      \"relatedSpdxElement\": \"${id}\"}")
  math(EXPR relations "${relations} + 1")
  set(relations ${relations} PARENT_SCOPE)
  set(document "${document}" PARENT_SCOPE)
endfunction()

add_package(motiongan "${VERSION}" "${LICENCE}")

foreach(part IN LISTS COMPILED_IN)
  string(REGEX MATCH "^([^|]+)\\|([^|]*)\\|(.+)$" part "${part}")
  set(name "${CMAKE_MATCH_1}")
  add_package("${name}" "${CMAKE_MATCH_2}" "${CMAKE_MATCH_3}")
  relate(STATIC_LINK "${name}")
endforeach()

# The Debian package that holds a library, or the library itself where that is not known.
find_program(DPKG_QUERY dpkg-query)
foreach(binary IN LISTS BINARIES)
  execute_process(COMMAND "${READELF}" -d "${binary}" OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "[][]" "|" dynamic "${dynamic}")   # lists are not cut at unbalanced brackets
  string(REGEX MATCHALL "\\(NEEDED\\)[^\n|]*\\|[^|]+" needed "${dynamic}")
  list(TRANSFORM needed REPLACE ".*\\|" "")
  foreach(library IN LISTS needed)
    if(library IN_LIST seen)
      continue()
    endif()
    list(APPEND seen "${library}")
    set(owner "")
    if(DPKG_QUERY)
      execute_process(COMMAND "${DPKG_QUERY}" -S "*/${LIBRARY_ARCHITECTURE}/${library}" OUTPUT_VARIABLE owner ERROR_QUIET)
      string(REGEX MATCH "^[^:, ]+" owner "${owner}")
    endif()
    if(owner)
      execute_process(COMMAND "${DPKG_QUERY}" -W -f "\${Version}|\${Architecture}\n" "${owner}"
        OUTPUT_VARIABLE found COMMAND_ERROR_IS_FATAL ANY)
      string(REGEX MATCH "^([^|]*)\\|([^\n]*)" found "${found}")
      set(version "${CMAKE_MATCH_1}")
      set(purl "${owner}@${version}?arch=${CMAKE_MATCH_2}")
      string(REPLACE ":" "%3A" purl "${purl}")
      string(REPLACE "+" "%2B" purl "${purl}")
      add_package("${owner}" "${version}" NOASSERTION "pkg:deb/debian/${purl}")
    else()
      set(owner "${library}")
      add_package("${owner}" "" NOASSERTION)
    endif()
    if(NOT owner IN_LIST linked)
      list(APPEND linked "${owner}")
      relate(DYNAMIC_LINK "${owner}")
    endif()
  endforeach()
endforeach()

# The name space is one of these contents; the time is that of SOURCE_DATE_EPOCH where it is set.
string(UUID uuid NAMESPACE 6ba7b811-9dad-11d1-80b4-00c04fd430c8 NAME "${document}" TYPE SHA1)
string(TIMESTAMP now "%Y-%m-%dT%H:%M:%SZ" UTC)
string(JSON document SET "${document}" name "\"motiongan-${VERSION}\"")
string(JSON document SET "${document}" documentNamespace "\"urn:uuid:${uuid}\"")
string(JSON document SET "${document}" creationInfo created "\"${now}\"")
file(WRITE "${OUT}" "${document}\n")
